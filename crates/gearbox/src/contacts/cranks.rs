//! Bearings of discs on the cranks of an RV reducer.
//!
//! ```text
//! H_ij = r_i + bore j of disc i          C_ij = S_j + s_j + e_i u(gamma_j + phi_i),  gamma_j = (1 + rho) psi - rho phi
//! d = H - C,   F = [K max(0, |d| - g)^p + c |d|'] d/|d|  on the crank
//! elastic support   sum_i F_ij = k s_j         elastic mesh   a_i = e_i u(gamma_j + phi_i) + t_j R90 e_i u(gamma_j + phi_i),
//! (both at rest)                                               sum_i (R90 e_i u(gamma_j + phi_i)).F_ij = k_m r^2 t_j
//! crank   m_j = sum_i a_i x F_ij               input   -rho m_j       output   (1 + rho) m_j + S_j x sum_i F_ij
//! ```
//! S_j is the crank's position on the output, t_j its rotation in the mesh of its planet of base radius r, and a_i the position
//! of an eccentric on its crank in C_ij and m_j. Supports and mesh are springs without mass, so that s_j and t_j follow from
//! the positions of the other bodies; dampers are parallel to them. The planets' mesh turns the output by a force across S_j at
//! the crank. The load that a crank transmits to the output is therefore one force at its centre.

mod derivatives;

use arrayvec::ArrayVec;
use pinwheel_contact::{Complex, Dual, Scalar};
use pinwheel_mbs::{BodyState, ContactEnergy, Wrench};
use pinwheel_scene::bearings::BearingLaw;

use super::bearing_load::BearingLoad;
use super::motion::Motion;
use super::pair::PairContact;
use crate::geometry::Geometry;
use crate::scene::{Cranks as CranksOfScene, Scene};
use crate::{Layout, Sleeve};

/// Largest number of discs of a scene.
const WHEELS: usize = 64;
/// Bearings of a crank, one per disc.
pub(super) type OfCrank = ArrayVec<CrankBearing, WHEELS>;
/// Largest numbers of Newton steps for the position of a crank and of halvings of one step, and the tolerance of the forces.
const STEPS: usize = 40;
const HALVINGS: usize = 8;
const LEFT: f64 = 1e-14;

/// All cranks of a gear, with their bearings, supports and mesh.
#[derive(Debug, Clone)]
pub struct CrankSet {
    pub(crate) law: BearingLaw,
    /// Distance of the cranks from the gear's axis, m.
    pub(crate) circle_radius_m: f64,
    layout: Layout,
    /// Ratio rho of the first stage.
    teeth_ratio: f64,
    /// Stiffness k of a support, N/m; `None`: rigid.
    support: Option<f64>,
    /// Mesh stiffness k_m r^2 over the square of the largest eccentricity, N/m (`None`: rigid), and that eccentricity, m.
    mesh: Option<f64>,
    throw_m: f64,
    /// Phase errors of the cranks, rad.
    phases: Vec<f64>,
    /// Eccentrics of each disc on all cranks, m, for a crank's angle of 0.
    eccentrics: Vec<[f64; 2]>,
    /// Bores of each disc in its frame, m, and their clearance beyond that of the bearing, m.
    bores: Vec<Vec<([f64; 2], f64)>>,
}

/// Bearing of a crank in one disc.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct CrankBearing<S = f64> {
    /// Load of the bearing at the bore's centre; the offset is that centre less the eccentric's.
    pub(super) load: BearingLoad<S>,
    /// Velocity of the offset where the support is rigid, m/s.
    velocity: Complex<S>,
    /// Bore's centre relative to the disc's, and the eccentric's relative to the crank's, m, ground frame.
    pub(super) arm: Complex<S>,
    eccentric: Complex<S>,
    /// Displacement of the eccentric as its crank turns in an elastic mesh, per displacement at the largest eccentricity.
    across: Complex<S>,
}

/// Deflection of a crank, m: two components in its support, and its turn in the mesh at the largest eccentricity.
type Deflection = [f64; 3];

/// Symmetric matrix of springs, N/m: rows and columns of the support, then of the mesh.
#[derive(Debug, Clone, Copy)]
struct Springs {
    support: [f64; 3],
    both: [f64; 2],
    mesh: f64,
}

impl Springs {
    /// Adds a bearing's stiffness xx, xy and yy, with the displacement `across` of its eccentric.
    fn add(&mut self, [xx, xy, yy]: [f64; 3], Complex { re: x, im: y }: Complex) {
        for (sum, k) in self.support.iter_mut().zip([xx, xy, yy]) {
            *sum += k;
        }
        let [along, beside] = [xx * x + xy * y, xy * x + yy * y];
        self.both = [self.both[0] + along, self.both[1] + beside];
        self.mesh += along * x + beside * y;
    }

    /// Returns the deflection under a force.
    fn solve(&self, [x, y, turning]: Deflection) -> Deflection {
        let ([xx, xy, yy], [a, b], c) = (self.support, self.both, self.mesh);
        let (xx, xy, yy) = (xx - a * a / c, xy - a * b / c, yy - b * b / c);
        let (x, y) = (x - a * turning / c, y - b * turning / c);
        let determinant = xx * yy - xy * xy;
        let offset = [
            (yy * x - xy * y) / determinant,
            (xx * y - xy * x) / determinant,
        ];
        let rest = turning - a * offset[0] - b * offset[1];
        [offset[0], offset[1], rest / c]
    }
}

impl<S: Scalar> CrankBearing<S> {
    /// Returns the bearing with its load at a deflection of its crank.
    #[inline]
    fn loaded(&self, law: &BearingLaw, [x, y, turned]: [S; 3]) -> Self {
        let moved = self.across.scale(turned);
        let [dx, dy] = self.load.offset_m;
        let offset = [dx - x - moved.re, dy - y - moved.im];
        Self {
            load: BearingLoad::of(law, offset, self.velocity.to_array(), self.load.turning),
            eccentric: self.eccentric + moved,
            ..*self
        }
    }

    fn on_crank(&self) -> Complex<S> {
        let [x, y] = self.load.on_wheel;
        -Complex::new(x, y)
    }

    /// Returns the moments of the bearing's force about the disc's centre and about the crank's axis, N m. The force points
    /// along the offset, so that its lever at the bore's centre is the eccentric's.
    fn moments(&self) -> [S; 2] {
        let (force, drag) = (self.on_crank(), self.load.drag_n_m);
        [
            drag - self.arm.cross(force),
            self.eccentric.cross(force) - drag,
        ]
    }
}

/// Returns the force at rest of a bearing at an offset, N.
fn pressed<S: Scalar>(law: &BearingLaw, [x, y]: [S; 2]) -> Complex<S> {
    let along = Complex::new(x, y);
    let offset = along.norm();
    let beyond = offset - x.like(law.clearance_m);
    if beyond.value() <= 0.0 || offset.value() == 0.0 {
        return Complex::<f64>::default().like(x);
    }
    along.scale(law.elastic(beyond) / offset)
}

impl CrankSet {
    pub(crate) fn of(
        law: BearingLaw,
        cranks: &CranksOfScene,
        scene: &Scene,
        geometry: &Geometry,
    ) -> Self {
        let wheels = geometry.wheel_phases.iter().zip(&geometry.eccentricities_m);
        let bore = |wheel: usize, crank: usize| {
            let centre = geometry.hole_centres[wheel][crank];
            let shaft = geometry.internal_radii_m[crank] + scene.gear.eccentricity_m;
            (
                [centre.re, centre.im],
                geometry.hole_radii_m[wheel][crank] - shaft,
            )
        };
        let of_wheel = |wheel: usize| (0..cranks.count).map(|crank| bore(wheel, crank)).collect();
        let throw_m = geometry
            .eccentricities_m
            .iter()
            .copied()
            .fold(0.0, f64::max);
        let planet = cranks.planet_base_radius_m() / throw_m;
        Self {
            law,
            circle_radius_m: cranks.circle_radius_m,
            layout: Layout::of(&scene.gear),
            teeth_ratio: geometry.teeth_ratio,
            support: cranks.support_stiffness_n_m,
            mesh: cranks.mesh_stiffness_n_m.map(|mesh| mesh * planet * planet),
            throw_m,
            phases: geometry.crank_phases.clone(),
            eccentrics: wheels
                .map(|(phase, e)| [e * phase.cos(), e * phase.sin()])
                .collect(),
            bores: (0..scene.gear.wheels).map(of_wheel).collect(),
        }
    }

    /// Reduces deflections and clearance, see [`Carrier::share`](crate::carrier::Carrier::share).
    pub(crate) fn share(&self, share: f64, of_clearance: f64) -> Self {
        let mut less = self.clone();
        less.law = self.law.share(share, of_clearance);
        less.support = self.support.map(|support| support / share);
        less.mesh = self.mesh.map(|mesh| mesh / share);
        for (_, clearance) in less.bores.iter_mut().flatten() {
            *clearance *= of_clearance;
        }
        less
    }

    /// Returns the load of a crank's bearing in a disc, and the bore's centre, m, ground frame. The offset is the bore's centre
    /// less the eccentric's.
    pub(crate) fn bearing(
        &self,
        bodies: &[BodyState],
        wheel: usize,
        crank: usize,
    ) -> (BearingLoad, [f64; 2]) {
        let mut bearings = OfCrank::new();
        self.crank(bodies, crank, &mut bearings);
        let body = bodies[self.layout.wheel_bodies().start + wheel];
        let CrankBearing { load, arm, .. } = bearings[wheel];
        (load, [body.x + arm.re, body.y + arm.im])
    }

    /// Returns the total load of the bearings of all cranks in a disc, with the mean of their offsets.
    pub(crate) fn of_wheel(&self, bodies: &[BodyState], wheel: usize) -> BearingLoad {
        let mut all = BearingLoad::default();
        let share = 1.0 / self.count() as f64;
        for crank in 0..self.count() {
            let (one, _) = self.bearing(bodies, wheel, crank);
            for k in 0..2 {
                all.on_wheel[k] += one.on_wheel[k];
                all.offset_m[k] += share * one.offset_m[k];
            }
            all.drag_n_m += one.drag_n_m;
        }
        all
    }

    /// Returns the load of a crank's bearing in a disc as a pair of disc and crank.
    pub(crate) fn pair(&self, bodies: &[BodyState], wheel: usize, crank: usize) -> PairContact {
        let (load, point) = self.bearing(bodies, wheel, crank);
        let ([dx, dy], [fx, fy]) = (load.offset_m, load.on_wheel);
        let offset = dx.hypot(dy);
        let normal = match offset > 0.0 {
            true => [-dx / offset, -dy / offset],
            false => [0.0; 2],
        };
        let seat = bodies[self.layout.sleeve_body(Sleeve::Internal(crank))];
        PairContact {
            wheel,
            sleeve: Sleeve::Internal(crank),
            point,
            normal,
            penetration_m: offset - self.law(wheel, crank).clearance_m,
            normal_rate_m_s: load.rate,
            tangential_rate_m_s: 0.0,
            stiffness: self.law.stiffness,
            normal_force_n: fx.hypot(fy),
            friction_force_n: 0.0,
            along_force_n: 0.0,
            centre: [seat.x, seat.y],
            pin_n_m: None,
            shared_j: 0.0,
        }
    }

    /// Returns the bearings that carry a force, as pairs.
    pub(crate) fn pairs(&self, bodies: &[BodyState]) -> Vec<PairContact> {
        let of_crank = |crank| (0..self.layout.wheels).map(move |wheel| (wheel, crank));
        let all = (0..self.count()).flat_map(of_crank);
        let pairs = all.map(|(wheel, crank)| self.pair(bodies, wheel, crank));
        pairs.filter(|pair| pair.normal_force_n > 0.0).collect()
    }

    fn count(&self) -> usize {
        self.phases.len()
    }

    /// Writes the bearings of one crank in all discs to `out`, and returns the crank's deflection.
    fn crank(&self, bodies: &[BodyState], crank: usize, out: &mut OfCrank) -> Deflection {
        let layout = self.layout;
        let [input, output] = [Layout::INPUT, Layout::OUTPUT].map(|body| &bodies[body]);
        let seat = &bodies[layout.internal_bodies().start + crank];
        let shaft = Motion {
            place: Complex::new(seat.x, seat.y),
            velocity: Complex::new(seat.vx, seat.vy),
            ..self.shaft(
                [output.angle, input.angle],
                [output.rate, input.rate],
                crank,
            )
        };
        let wheels = &bodies[layout.wheel_bodies()];
        out.clear();
        for (i, wheel) in wheels.iter().enumerate() {
            out.push(self.unloaded(i, crank, &Motion::of(wheel), &shaft));
        }
        let offset = match (self.support, self.mesh) {
            (None, None) => [0.0; 3],
            _ => self.deflection(crank, out),
        };
        for (i, bearing) in out.iter_mut().enumerate() {
            *bearing = bearing.loaded(&self.law(i, crank), offset);
        }
        offset
    }

    /// Returns the motion of a crank about the origin from the angles and rates of output and input.
    #[inline]
    fn shaft<S: Scalar>(&self, angles: [S; 2], rates: [S; 2], crank: usize) -> Motion<S> {
        let c = |x: f64| rates[0].like(x);
        let (rho, still) = (
            c(self.teeth_ratio),
            Complex::<f64>::default().like(rates[0]),
        );
        let turned = |[output, input]: [S; 2]| (c(1.0) + rho) * output - rho * input;
        Motion {
            place: still,
            velocity: still,
            turn: Complex::unit(turned(angles) + c(self.phases[crank])),
            rate: turned(rates),
        }
    }

    /// Returns the bearing of a disc on a crank without deflection, with a load still to be computed.
    #[inline]
    fn unloaded<S: Scalar>(
        &self,
        wheel: usize,
        crank: usize,
        disc: &Motion<S>,
        shaft: &Motion<S>,
    ) -> CrankBearing<S> {
        let like = |point: [f64; 2]| Complex::from(point).like(disc.rate);
        let eccentric = like(self.eccentrics[wheel]) * shaft.turn;
        let arm = like(self.bores[wheel][crank].0) * disc.turn;
        let (zero, throw) = (disc.rate.like(0.0), disc.rate.like(self.throw_m));
        CrankBearing {
            load: BearingLoad {
                on_wheel: [zero; 2],
                offset_m: (disc.place + arm - shaft.place - eccentric).to_array(),
                drag_n_m: zero,
                turning: disc.rate - shaft.rate,
                rate: zero,
            },
            velocity: disc.velocity + arm.turned().scale(disc.rate)
                - shaft.velocity
                - eccentric.turned().scale(shaft.rate),
            arm,
            eccentric,
            across: Complex::new(-eccentric.im / throw, eccentric.re / throw),
        }
    }

    /// Returns the bearing's law in a bore with its additional clearance.
    pub(crate) fn law(&self, wheel: usize, crank: usize) -> BearingLaw {
        let (_, extra_m) = self.bores[wheel][crank];
        BearingLaw {
            clearance_m: self.law.clearance_m + extra_m,
            ..self.law
        }
    }

    /// Returns the springs and forces with the rigid directions constrained: their deflections are 0.
    fn constrained(
        &self,
        mut springs: Springs,
        [x, y, turning]: Deflection,
    ) -> (Springs, Deflection) {
        let constrained = [self.support.is_none(), self.mesh.is_none()];
        if constrained[0] {
            springs.support = [1.0, 0.0, 1.0];
        }
        if constrained[1] {
            springs.mesh = 1.0;
        }
        if constrained != [false; 2] {
            springs.both = [0.0; 2];
        }
        let free = |constrained: bool, force: f64| if constrained { 0.0 } else { force };
        let left = [
            free(constrained[0], x),
            free(constrained[0], y),
            free(constrained[1], turning),
        ];
        (springs, left)
    }

    /// Returns the springs of support and mesh only.
    fn springs(&self) -> Springs {
        let support = self.support.unwrap_or_default();
        Springs {
            support: [support, 0.0, support],
            both: [0.0; 2],
            mesh: self.mesh.unwrap_or_default(),
        }
    }

    /// Solves the deflection of a crank, the only equilibrium of a convex potential, by Newton's method from rest.
    fn deflection(&self, crank: usize, bearings: &[CrankBearing]) -> Deflection {
        let own = self.springs();
        let ([support, ..], mesh) = (own.support, own.mesh);
        // Residual force, its derivatives, and the sum of the forces' magnitudes.
        let left = |[x, y, turned]: Deflection| {
            let (mut force, mut springs, mut size) = (
                [-support * x, -support * y, -mesh * turned],
                own,
                support * x.hypot(y) + mesh * turned.abs(),
            );
            for (i, bearing) in bearings.iter().enumerate() {
                let law = self.law(i, crank);
                let Complex { re: ax, im: ay } = bearing.across;
                let [dx, dy] = bearing.load.offset_m;
                let offset = [dx - x - turned * ax, dy - y - turned * ay];
                let Complex { re: fx, im: fy } = pressed(&law, Dual::variables(offset));
                springs.add([fx.by[0], fx.by[1], fy.by[1]], bearing.across);
                let (fx, fy) = (fx.value, fy.value);
                force = [force[0] + fx, force[1] + fy, force[2] + ax * fx + ay * fy];
                size += fx.hypot(fy);
            }
            let (springs, force) = self.constrained(springs, force);
            (force, springs, size)
        };
        let length = |[x, y, turning]: Deflection| x.hypot(y).hypot(turning);
        let mut offset = [0.0; 3];
        let (mut force, mut springs, mut size) = left(offset);
        for _ in 0..STEPS {
            let most = length(force);
            if most <= LEFT * size {
                break;
            }
            let step = springs.solve(force);
            let mut share = 1.0;
            let mut next = None;
            for _ in 0..HALVINGS {
                let there = [0, 1, 2].map(|k| offset[k] + share * step[k]);
                let balance = left(there);
                if length(balance.0) < most {
                    next = Some((there, balance));
                    break;
                }
                share *= 0.5;
            }
            // Rounding prevents further progress.
            let Some((there, balance)) = next else { break };
            offset = there;
            (force, springs, size) = balance;
        }
        offset
    }

    /// Adds the loads of all cranks' bearings.
    pub(crate) fn add_loads(&self, bodies: &[BodyState], loads: &mut [Wrench]) {
        let layout = self.layout;
        let mut bearings = OfCrank::new();
        for (crank, body) in layout.internal_bodies().enumerate() {
            self.crank(bodies, crank, &mut bearings);
            let (mut sum, mut moment) = (Complex::<f64>::default(), 0.0);
            for (wheel, bearing) in layout.wheel_bodies().zip(&bearings) {
                let (force, [on_disc, on_crank]) = (bearing.on_crank(), bearing.moments());
                sum = sum + force;
                moment += on_crank;
                loads[wheel].fx -= force.re;
                loads[wheel].fy -= force.im;
                loads[wheel].moment += on_disc;
            }
            let [fx, fy] = self.with_mesh(sum.to_array(), moment, &bodies[body]);
            loads[body].fx += fx;
            loads[body].fy += fy;
            loads[Layout::INPUT].moment -= self.teeth_ratio * moment;
        }
    }

    /// Returns the force of a crank on the output, N: that of its bearings, and that of its planet's mesh under the crank's
    /// moment.
    fn with_mesh(
        &self,
        force: [f64; 2],
        moment: f64,
        &BodyState { x, y, .. }: &BodyState,
    ) -> [f64; 2] {
        let across = (1.0 + self.teeth_ratio) * moment / (x * x + y * y);
        [force[0] - across * y, force[1] + across * x]
    }

    /// Adds the energy that bearings and supports store, and the powers that they lose.
    pub(crate) fn add_energy(&self, bodies: &[BodyState], sum: &mut ContactEnergy) {
        let mut bearings = OfCrank::new();
        for crank in 0..self.count() {
            let [x, y, turned] = self.crank(bodies, crank, &mut bearings);
            sum.stored_j += 0.5 * self.support.unwrap_or_default() * (x * x + y * y);
            sum.stored_j += 0.5 * self.mesh.unwrap_or_default() * turned * turned;
            for (wheel, bearing) in bearings.iter().enumerate() {
                bearing.load.add_energy(&self.law(wheel, crank), sum);
            }
        }
    }
}
