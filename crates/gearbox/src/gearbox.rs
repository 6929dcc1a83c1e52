//! Compiled scene: geometry, bodies, joints and contacts.

use pinwheel_mbs::{Body, BodyState, Driver, ErrorScales, Mechanism, Motion, Revolute};
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::norms::{Distance, LoadFloor};

use crate::Layout;
use crate::carrier::Carrier;
use crate::contacts::{self, ContactField, Kernel, Seals};
use crate::error::GearboxError;
use crate::geometry::Geometry;
use crate::load_profile;
use crate::ring_frame;
use crate::scene::{BodyMass, CheckedScene, Fault, OutputPart, Scene, Solver, Start};
use crate::speed_profile;
use crate::statics::Statics;
use pinwheel_scene::channels::Channels;
use pinwheel_scene::scales::{hertz, least_depth};

/// Scene compiled to bodies, joints and contacts. Body order: [`Layout`].
#[derive(Debug, Clone)]
pub struct Gearbox {
    /// Checked scene.
    pub scene: CheckedScene,
    /// Body indices.
    pub layout: Layout,
    /// Derived geometry.
    pub geometry: Geometry,
    /// Support of the discs.
    pub carrier: Carrier,
    /// Channels recorded besides the contract's columns.
    pub channels: Channels,
    /// Contact loop in use.
    pub kernel: Kernel,
    /// Initial states other than the ideal mesh's.
    pub(crate) start: Option<Vec<BodyState>>,
    /// K of a ring pin on a straight edge, N/m^1.5. It is stored because computing the wall thickness behind the holes takes
    /// longer than an equilibrium.
    flat_stiffness: f64,
}

impl Gearbox {
    /// Compiles a checked scene.
    ///
    /// # Errors
    /// Parameters whose fault shows only when the model is built (see [`GearboxError`]).
    pub fn new(scene: &CheckedScene) -> Result<Self, GearboxError> {
        Self::after(None, scene)
    }

    /// Compiles a checked scene like [`new`](Self::new), at less cost if `earlier` is a similar gearbox.
    ///
    /// # Errors
    /// Errors of [`new`](Self::new).
    pub fn after(earlier: Option<&Self>, scene: &CheckedScene) -> Result<Self, GearboxError> {
        pinwheel_faults::compiled();
        let earlier = earlier.map(|gearbox| &gearbox.geometry);
        let at_work = scene.at_work();
        let geometry = Geometry::after(earlier, &at_work)?;
        let mut gearbox = Self {
            scene: scene.clone(),
            layout: Layout::of(&scene.gear),
            carrier: Carrier::of(&at_work, &geometry),
            geometry,
            channels: Channels::of(scene).map_err(GearboxError::Geometry)?,
            kernel: Kernel::default(),
            start: None,
            flat_stiffness: hertz(scene).on_flat(scene.gear.external_sleeve_radius_m),
        };
        gearbox.field_of(&gearbox.scene)?;
        if scene.drive.start == Start::Equilibrium {
            let start = Statics::new(&gearbox)?.moving()?;
            gearbox.start = Some(start);
        }
        Ok(gearbox)
    }

    /// Returns the gearbox with other settings of the solver. Results of the gear, its masses, loads and contacts are reused,
    /// above all the equilibrium at the start.
    ///
    /// # Errors
    /// Settings that the checks refuse.
    pub fn with_solver(&self, change: impl FnOnce(&mut Solver)) -> Result<Self, Fault> {
        Ok(Self {
            scene: self.scene.with_solver(change)?,
            ..self.clone()
        })
    }

    /// Returns the gearbox that records these channels, by names or patterns; all other results are reused.
    ///
    /// # Errors
    /// A channel does not exist, or there are more channels than permitted.
    pub fn with_channels(&self, patterns: Vec<String>) -> Result<Self, GearboxError> {
        let scene = self
            .scene
            .changed(|scene| scene.output.channels = patterns)?;
        Ok(Self {
            channels: Channels::of(&scene).map_err(GearboxError::Geometry)?,
            scene,
            ..self.clone()
        })
    }

    /// Creates a contact field for this scene.
    ///
    /// # Errors
    /// Unknown law, or points too coarse for the profile.
    pub fn contact_field(&self) -> Result<ContactField, GearboxError> {
        Ok(ContactField {
            ring: self.scene.ring_turns().then(Box::default),
            ..self.field_of(&self.scene)?
        })
    }

    /// Returns all forces of a scene between its bodies, relative to the ring: contacts, bearings of floating discs, friction of pins,
    /// and seals.
    pub(crate) fn field_of(&self, scene: &Scene) -> Result<ContactField, GearboxError> {
        Ok(ContactField {
            carrier: self.carrier.clone(),
            seals: Seals::of(scene),
            ..contacts::contacts(&scene.at_work(), &self.geometry, self.kernel)?
        })
    }

    /// Returns the scene without friction at its contacts.
    fn frictionless(&self) -> Scene {
        let mut scene = self.scene.clone().into_scene();
        scene.contact.friction_coefficient = 0.0;
        scene.bearings.sleeve_friction_coefficient = None;
        scene
    }

    /// Creates the contacts only, without friction and bearings, relative to the ring.
    ///
    /// # Errors
    /// Errors of [`contact_field`](Self::contact_field).
    pub fn bare_field(&self) -> Result<ContactField, GearboxError> {
        contacts::contacts(&self.frictionless().at_work(), &self.geometry, self.kernel)
    }

    /// Creates a contact field for this scene with a friction coefficient of 0.
    ///
    /// # Errors
    /// Errors of [`contact_field`](Self::contact_field).
    pub fn frictionless_field(&self) -> Result<ContactField, GearboxError> {
        self.field_of(&self.frictionless())
    }

    /// True if discs slide on pins with friction: on fixed pins, or on sleeves that they turn.
    pub fn has_friction(&self) -> bool {
        self.scene.slides()
    }

    /// Returns the bodies of the pins whose spins are unknowns: those that turn freely under friction. Without friction nothing
    /// turns a pin; cranks turn with their planets, which are not separate bodies.
    pub fn spinning(&self) -> Vec<usize> {
        let (gear, layout) = (&self.scene.gear, &self.layout);
        let [external, internal] = self.scene.sliding().map(|coefficient| coefficient > 0.0);
        let ring = layout.external_bodies();
        let output = layout.internal_bodies();
        let ring = ring.filter(|_| external && gear.external_sleeves_turn);
        let output = output.filter(|_| internal && gear.internal_sleeves_turn);
        ring.chain(output).collect()
    }

    /// Returns a moment on the output (N m) as one on the carrier's turn against the ring while the input is locked.
    pub fn along_carrier_n_m(&self, load_n_m: f64) -> f64 {
        if self.scene.ring_turns() {
            -load_n_m
        } else {
            load_n_m
        }
    }

    /// Returns the twist of plate, flange and input shaft, rad, under a torque on the output, N m; 0 where they are rigid.
    pub fn flange_twist_rad(&self, torque_n_m: f64) -> f64 {
        self.scene.flange_twist_rad(torque_n_m)
    }

    /// True if discs float on elastic bearings.
    pub fn floats(&self) -> bool {
        self.carrier.floats()
    }

    /// Returns the load torque on the output shaft at time `t`, N m (counter-clockwise positive); at a jump, its value after
    /// the jump.
    pub fn load_torque(&self, t: f64) -> f64 {
        load_profile::piece_at(&self.scene.drive, t).torque(t)
    }

    /// Returns the scales of errors for adaptive methods: the elastic twist of a disc under its largest static load, and the
    /// angular frequency of its vibration at that stiffness.
    ///
    /// The largest static pin force is about 4 T/(e zs zk) a disc (linear springs, no clearance). Its penetration is
    /// (F/K)^(2/3), and the twist is the penetration over the lever e zs.
    pub fn error_scales(&self) -> ErrorScales {
        let gear = &self.scene.gear;
        let lever = gear.lever_m();
        let per_force = 0.25 * lever * gear.external_sleeves as f64;
        let torque = (self.scene.largest_disc_load_n_m()).max(self.least_force_n() * per_force);
        let force = 4.0 * torque / (lever * gear.external_sleeves as f64);
        let penetration = (force / self.flat_stiffness).powf(2.0 / 3.0);
        let angle = penetration / lever;
        // Torsional stiffness of the loaded half of the pins against the disc's inertia.
        let torsion = 1.5 * torque / angle;
        ErrorScales {
            length: penetration,
            angle,
            frequency: (torsion / self.scene.mass.wheel.moment_kg_m2).sqrt(),
        }
    }

    /// Returns the force floor, N: the Hertz force at a penetration of 1e-5 pin radii. It replaces the load as the reference for
    /// an unloaded gear and scales with its size.
    pub fn least_force_n(&self) -> f64 {
        self.flat_stiffness * least_depth(&self.scene).powf(1.5)
    }

    /// Returns the least force, N, and the torque of that force on the eccentric, N m.
    pub fn least_loads(&self) -> LoadFloor {
        let force_n = self.least_force_n();
        LoadFloor {
            force_n,
            torque_n_m: force_n * self.scene.gear.eccentricity_m,
        }
    }

    /// Returns the distance of `a` from the reference `b`, measured with the least loads of this gear ([`Distance::between`]).
    pub fn distance(&self, a: &TimeSeries, b: &TimeSeries) -> Distance {
        Distance::between(a, b, self.least_loads())
    }

    /// Returns the motion of the input.
    pub fn input_motion(&self) -> Motion {
        Motion {
            rate: self.scene.drive.input_speed_rad_s,
            ..Motion::default()
        }
    }

    /// Returns the torque that accelerates the input shaft, with the discs that revolutes carry on it, at time `t` (s), N m.
    pub fn accelerating_torque_n_m(&self, t: f64) -> f64 {
        let shaft = self.scene.input_shaft().moment_kg_m2;
        let discs: f64 = match self.floats() {
            true => 0.0,
            false => (0..self.layout.wheels)
                .map(|i| self.geometry.wheel_state(i, [0.0; 2], [0.0; 2]))
                .map(|at| self.scene.mass.wheel.mass_kg * (at.x * at.x + at.y * at.y))
                .sum(),
        };
        (shaft + discs) * speed_profile::motion_at(&self.scene.drive, t).acceleration
    }

    /// Returns the states at t = 0 by `drive.start`.
    pub fn initial_states(&self) -> Vec<BodyState> {
        self.start
            .clone()
            .unwrap_or_else(|| self.kinematic_states())
    }

    /// Returns the states at t = 0 at the ideal mesh: with its rates, ring pins at rest, and internal pins turning with the
    /// output.
    pub fn kinematic_states(&self) -> Vec<BodyState> {
        self.to_ground(self.states_from_ring())
    }

    /// Returns states relative to the ring as those in the frame of the ground.
    pub(crate) fn to_ground(&self, relative: Vec<BodyState>) -> Vec<BodyState> {
        match self.scene.ring_turns() {
            true => ring_frame::from_carrier(&relative),
            false => relative,
        }
    }

    /// Returns the [`kinematic_states`](Self::kinematic_states) relative to the ring.
    pub(crate) fn states_from_ring(&self) -> Vec<BodyState> {
        let speed = self.scene.drive.input_speed_rad_s;
        let slow = self.geometry.ideal_output_angle(speed);
        let turning = self.geometry.ideal_eccentric_angle(speed);
        let mut states = vec![BodyState::default(); self.layout.bodies()];
        states[Layout::INPUT].rate = speed + self.geometry.input_per_carrier * slow;
        states[Layout::OUTPUT].rate = slow;
        for (i, body) in self.layout.wheel_bodies().enumerate() {
            let own = [self.geometry.ideal_wheel_angle(i, 0.0), slow];
            states[body] = self.geometry.wheel_state(i, [0.0, turning], own);
        }
        let eccentric_centres = self.geometry.external_points.iter();
        for (&[x, y], body) in eccentric_centres.zip(self.layout.external_bodies()) {
            (states[body].x, states[body].y) = (x, y);
        }
        for (k, body) in self.layout.internal_bodies().enumerate() {
            states[body] = self.geometry.internal_state(k, [0.0, slow]);
        }
        states
    }

    /// Returns the bodies, revolutes and drivers of the gearbox: 28 bodies and 29 joints for the paper's. Floating discs have
    /// no revolute; drivers without motion fix pins that do not turn.
    pub fn mechanism(&self) -> Mechanism {
        let (layout, mass) = (self.layout, &self.scene.mass);
        let starts = self.initial_states();
        let body = |name: String, m: BodyMass, index: usize| Body {
            name,
            mass: m.mass_kg,
            moment: m.moment_kg_m2,
            start: starts[index],
        };
        let mut bodies = vec![
            body(
                "input shaft".into(),
                self.scene.input_shaft(),
                Layout::INPUT,
            ),
            body(
                "output shaft".into(),
                self.scene.output_shaft(),
                Layout::OUTPUT,
            ),
        ];
        let pin = |parent, parent_point, child| Revolute {
            parent,
            parent_point,
            child,
            child_point: [0.0; 2],
        };
        let mut revolutes = vec![
            pin(None, [0.0; 2], Layout::INPUT),
            pin(None, [0.0; 2], Layout::OUTPUT),
        ];
        for (i, index) in layout.wheel_bodies().enumerate() {
            bodies.push(body(format!("disc {i}"), mass.wheel, index));
            if self.floats() {
                continue;
            }
            let BodyState { x, y, .. } = self.geometry.wheel_state(i, [0.0; 2], [0.0; 2]);
            revolutes.push(pin(Some(Layout::INPUT), [x, y], index));
        }
        let (ring, carrier) = match self.scene.drive.output {
            OutputPart::Carrier => (None, Some(Layout::OUTPUT)),
            OutputPart::Ring => (Some(Layout::OUTPUT), None),
        };
        for (j, index) in layout.external_bodies().enumerate() {
            let name = format!("ring pin {j}");
            bodies.push(body(name, mass.external_sleeve, index));
            revolutes.push(pin(ring, self.geometry.external_points[j], index));
        }
        for (k, index) in layout.internal_bodies().enumerate() {
            let name = format!("output pin {k}");
            bodies.push(body(name, mass.internal_sleeve, index));
            let point = self.geometry.internal_points[k];
            revolutes.push(pin(carrier, point, index));
        }
        let hold = |parent, child| Driver {
            parent,
            child,
            motion: Motion::default(),
            segments: Vec::new(),
        };
        let mut drivers = vec![Driver {
            motion: self.input_motion(),
            segments: speed_profile::motions(&self.scene.drive),
            ..hold(None, Layout::INPUT)
        }];
        let gear = &self.scene.gear;
        if !gear.external_sleeves_turn {
            drivers.extend(layout.external_bodies().map(|body| hold(ring, body)));
        }
        if !gear.internal_sleeves_turn {
            drivers.extend(layout.internal_bodies().map(|body| hold(carrier, body)));
        }
        Mechanism {
            bodies,
            revolutes,
            drivers,
        }
    }
}
