//! The bearings of discs on the cranks of an RV reducer.
//!
//! ```text
//! H_ij = r_i + bore j of disc i          C_ij = S_j + s_j + e_i u(gamma_j + phi_i),  gamma_j = (1 + rho) psi - rho phi
//! d = H - C,   F = [K max(0, |d| - g)^p + c |d|'] d/|d|  on the crank
//! elastic support   sum_i F_ij = k s_j         elastic mesh   a_i = e_i u(gamma_j + phi_i) + t_j R90 e_i u(gamma_j + phi_i),
//! (both at rest)                                               sum_i (R90 e_i u(gamma_j + phi_i)).F_ij = k_m r^2 t_j
//! crank   m_j = sum_i a_i x F_ij               input   -rho m_j       output   (1 + rho) m_j + S_j x sum_i F_ij
//! ```
//! S_j: the crank's place on the output, t_j its turn in the mesh of its planet of base radius r, a_i in C_ij and in m_j the place of
//! an eccentric on its crank. Supports and mesh are springs without mass, so that s_j and t_j follow from the places of the other
//! bodies; dampers bridge them. The planets' mesh turns the output by a force across S_j at the crank, so that what a crank
//! carries, and hands to the output, is one force at its centre.

mod derivatives;

use arrayvec::ArrayVec;
use pinwheel_mbs::{BodyState, ContactEnergy, Wrench};
use pinwheel_scene::bearings::BearingLaw;

use super::bearing_load::BearingLoad;
use super::pair::PairContact;
use crate::geometry::Geometry;
use crate::scene::{Cranks as CranksOfScene, Scene};
use crate::{Layout, Sleeve};

/// Discs at most: as many as a scene may have.
const WHEELS: usize = 64;
/// A crank's bearings, one a disc.
pub(super) type OfCrank = ArrayVec<CrankBearing, WHEELS>;
/// Steps of Newton's method for the place of a crank, halvings of one, and what may be left of the forces.
const STEPS: usize = 40;
const HALVINGS: usize = 8;
const LEFT: f64 = 1e-14;

/// All cranks.
#[derive(Debug, Clone)]
pub struct CrankSet {
    pub(crate) law: BearingLaw,
    /// Distance of the cranks from the gear's axis, m.
    pub(crate) circle_radius_m: f64,
    layout: Layout,
    /// rho
    teeth_ratio: f64,
    /// k, N/m.
    support: Option<f64>,
    /// k_m r^2 over the square of the largest eccentricity, N/m; and that eccentricity, m.
    mesh: Option<f64>,
    throw_m: f64,
    /// Angles by which cranks are out of phase, rad.
    phases: Vec<f64>,
    /// Eccentrics of each disc on all cranks, m, for a crank's angle of 0.
    eccentrics: Vec<[f64; 2]>,
    /// Bores of each disc in its frame, m, and their clearance beyond that of the bearing, m.
    bores: Vec<Vec<([f64; 2], f64)>>,
}

/// A crank's bearing in one disc.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct CrankBearing {
    /// Its force at the bore's centre; the offset is that centre less the eccentric's.
    pub(super) load: BearingLoad,
    /// The offset's velocity where the support is rigid, m/s.
    velocity: [f64; 2],
    /// Bore's centre from the disc's, and the eccentric's from the crank's, m, ground frame.
    pub(super) arm: [f64; 2],
    eccentric: [f64; 2],
    /// How far the eccentric moves as its crank turns in an elastic mesh, by the largest eccentricity.
    across: [f64; 2],
}

/// How far a crank gives way, m: in its support, and at the largest eccentricity by its turn in the mesh.
type Deflection = [f64; 3];

/// A symmetric matrix of springs, N/m: rows and columns of the support, then of the mesh.
#[derive(Debug, Clone, Copy)]
struct Springs {
    support: [f64; 3],
    both: [f64; 2],
    mesh: f64,
}

impl Springs {
    /// Adds a bearing's xx, xy and yy, where its eccentric moves `across`.
    fn add(&mut self, [xx, xy, yy]: [f64; 3], [x, y]: [f64; 2]) {
        for (sum, k) in self.support.iter_mut().zip([xx, xy, yy]) {
            *sum += k;
        }
        let [along, beside] = [xx * x + xy * y, xy * x + yy * y];
        self.both = [self.both[0] + along, self.both[1] + beside];
        self.mesh += along * x + beside * y;
    }

    /// How far they give way under a force.
    fn solve(&self, [x, y, turning]: Deflection) -> Deflection {
        let ([xx, xy, yy], [a, b], c) = (self.support, self.both, self.mesh);
        let (xx, xy, yy) = (xx - a * a / c, xy - a * b / c, yy - b * b / c);
        let (x, y) = (x - a * turning / c, y - b * turning / c);
        let determinant = xx * yy - xy * xy;
        let given = [
            (yy * x - xy * y) / determinant,
            (xx * y - xy * x) / determinant,
        ];
        let rest = turning - a * given[0] - b * given[1];
        [given[0], given[1], rest / c]
    }
}

impl CrankBearing {
    fn on_crank(&self) -> [f64; 2] {
        self.load.on_wheel.map(|f| -f)
    }
}

/// Force at rest of a bearing at an offset, N, and its derivatives xx, xy, yy, N/m.
fn pressed(law: &BearingLaw, [dx, dy]: [f64; 2]) -> ([f64; 2], [f64; 3]) {
    let offset = dx.hypot(dy);
    let beyond = offset - law.clearance_m;
    if beyond <= 0.0 || offset == 0.0 {
        return Default::default();
    }
    let [nx, ny] = [dx / offset, dy / offset];
    let force = law.elastic(beyond);
    let (along, across) = (law.exponent * force / beyond, force / offset);
    let derivatives = [
        along * nx * nx + across * ny * ny,
        (along - across) * nx * ny,
        along * ny * ny + across * nx * nx,
    ];
    ([force * nx, force * ny], derivatives)
}

fn turned([x, y]: [f64; 2], (s, c): (f64, f64)) -> [f64; 2] {
    [c * x - s * y, s * x + c * y]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
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

    /// See [`Carrier::share`](crate::carrier::Carrier::share).
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

    /// Load of a crank's bearing in a disc, whose offset is the bore's centre from the eccentric's, and the bore's centre, m,
    /// ground frame.
    pub(crate) fn bearing(
        &self,
        bodies: &[BodyState],
        wheel: usize,
        crank: usize,
    ) -> (BearingLoad, [f64; 2]) {
        let mut found = OfCrank::new();
        self.crank(bodies, crank, &mut found);
        let (body, [x, y]) = (
            bodies[self.layout.wheel_bodies().start + wheel],
            found[wheel].arm,
        );
        (found[wheel].load, [body.x + x, body.y + y])
    }

    /// Load of the bearings of all cranks in a disc together, whose offset is their mean.
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

    /// Load of a crank's bearing in a disc as a pair of disc and crank.
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
        }
    }

    /// Bearings that carry a force, as pairs.
    pub(crate) fn pairs(&self, bodies: &[BodyState]) -> Vec<PairContact> {
        let of_crank = |crank| (0..self.layout.wheels).map(move |wheel| (wheel, crank));
        let all = (0..self.count()).flat_map(of_crank);
        let pairs = all.map(|(wheel, crank)| self.pair(bodies, wheel, crank));
        pairs.filter(|pair| pair.normal_force_n > 0.0).collect()
    }

    fn count(&self) -> usize {
        self.phases.len()
    }

    /// The bearings of one crank, of every disc, and how far the crank gives way.
    fn crank(&self, bodies: &[BodyState], crank: usize, out: &mut OfCrank) -> Deflection {
        let layout = self.layout;
        let (input, output) = (&bodies[Layout::INPUT], &bodies[Layout::OUTPUT]);
        let place = &bodies[layout.internal_bodies().start + crank];
        let rho = self.teeth_ratio;
        let angle = (1.0 + rho) * output.angle - rho * input.angle + self.phases[crank];
        let rate = (1.0 + rho) * output.rate - rho * input.rate;
        let turn = angle.sin_cos();
        let wheels = &bodies[layout.wheel_bodies()];
        out.clear();
        for (i, wheel) in wheels.iter().enumerate() {
            let eccentric = turned(self.eccentrics[i], turn);
            let arm = turned(self.bores[i][crank].0, wheel.angle.sin_cos());
            let velocity = [
                wheel.vx - wheel.rate * arm[1] - place.vx + rate * eccentric[1],
                wheel.vy + wheel.rate * arm[0] - place.vy - rate * eccentric[0],
            ];
            out.push(CrankBearing {
                load: BearingLoad {
                    offset_m: [
                        wheel.x + arm[0] - place.x - eccentric[0],
                        wheel.y + arm[1] - place.y - eccentric[1],
                    ],
                    turning: wheel.rate - rate,
                    ..BearingLoad::default()
                },
                arm,
                eccentric,
                across: [-eccentric[1] / self.throw_m, eccentric[0] / self.throw_m],
                velocity,
            });
        }
        let given = match (self.support, self.mesh) {
            (None, None) => [0.0; 3],
            _ => self.deflection(crank, out),
        };
        let [x, y, turned] = given;
        for (i, found) in out.iter_mut().enumerate() {
            let law = self.law(i, crank);
            let moved = found.across.map(|across| turned * across);
            found.eccentric = [found.eccentric[0] + moved[0], found.eccentric[1] + moved[1]];
            let [dx, dy] = found.load.offset_m;
            let offset = [dx - x - moved[0], dy - y - moved[1]];
            found.load = BearingLoad::of(&law, offset, found.velocity, found.load.turning);
        }
        given
    }

    /// The bearing's law in a bore with a clearance of its own.
    pub(crate) fn law(&self, wheel: usize, crank: usize) -> BearingLaw {
        let (_, extra_m) = self.bores[wheel][crank];
        BearingLaw {
            clearance_m: self.law.clearance_m + extra_m,
            ..self.law
        }
    }

    /// A matrix of springs in which what is rigid stays where it is, and the force that it leaves.
    fn held(&self, mut springs: Springs, [x, y, turning]: Deflection) -> (Springs, Deflection) {
        let is_held = [self.support.is_none(), self.mesh.is_none()];
        if is_held[0] {
            springs.support = [1.0, 0.0, 1.0];
        }
        if is_held[1] {
            springs.mesh = 1.0;
        }
        if is_held != [false; 2] {
            springs.both = [0.0; 2];
        }
        let free = |held: bool, force: f64| if held { 0.0 } else { force };
        let left = [
            free(is_held[0], x),
            free(is_held[0], y),
            free(is_held[1], turning),
        ];
        (springs, left)
    }

    /// Its support and mesh alone.
    fn springs(&self) -> Springs {
        let support = self.support.unwrap_or_default();
        Springs {
            support: [support, 0.0, support],
            both: [0.0; 2],
            mesh: self.mesh.unwrap_or_default(),
        }
    }

    /// How far a crank gives way: the one balance of a convex potential, from rest by Newton's method.
    fn deflection(&self, crank: usize, bearings: &[CrankBearing]) -> Deflection {
        let own = self.springs();
        let ([support, ..], mesh) = (own.support, own.mesh);
        // Force that is left, its derivatives, and the sum of the forces' sizes.
        let left = |[x, y, turned]: Deflection| {
            let (mut force, mut springs, mut size) = (
                [-support * x, -support * y, -mesh * turned],
                own,
                support * x.hypot(y) + mesh * turned.abs(),
            );
            for (i, bearing) in bearings.iter().enumerate() {
                let law = self.law(i, crank);
                let [ax, ay] = bearing.across;
                let [dx, dy] = bearing.load.offset_m;
                let offset = [dx - x - turned * ax, dy - y - turned * ay];
                let ([fx, fy], derivatives) = pressed(&law, offset);
                force = [force[0] + fx, force[1] + fy, force[2] + ax * fx + ay * fy];
                springs.add(derivatives, bearing.across);
                size += fx.hypot(fy);
            }
            let (springs, force) = self.held(springs, force);
            (force, springs, size)
        };
        let length = |[x, y, turning]: Deflection| x.hypot(y).hypot(turning);
        let mut given = [0.0; 3];
        let (mut force, mut springs, mut size) = left(given);
        for _ in 0..STEPS {
            let most = length(force);
            if most <= LEFT * size {
                break;
            }
            let step = springs.solve(force);
            let mut share = 1.0;
            let mut next = None;
            for _ in 0..HALVINGS {
                let there = [0, 1, 2].map(|k| given[k] + share * step[k]);
                let found = left(there);
                if length(found.0) < most {
                    next = Some((there, found));
                    break;
                }
                share *= 0.5;
            }
            // As near as rounding lets it come.
            let Some((there, found)) = next else { break };
            given = there;
            (force, springs, size) = found;
        }
        given
    }

    /// Moment of a crank about its own axis, which its planet carries, N m.
    fn moment(bearings: &[CrankBearing]) -> f64 {
        // The force points along the offset: at the bore's centre its lever is the eccentric's.
        let of = |bearing: &CrankBearing| {
            cross(bearing.eccentric, bearing.on_crank()) - bearing.load.drag_n_m
        };
        bearings.iter().map(of).sum()
    }

    /// Adds the loads of all of them.
    pub(crate) fn add_loads(&self, bodies: &[BodyState], loads: &mut [Wrench]) {
        let layout = self.layout;
        let mut found = OfCrank::new();
        for (crank, body) in layout.internal_bodies().enumerate() {
            self.crank(bodies, crank, &mut found);
            let mut sum = [0.0; 2];
            for (wheel, bearing) in layout.wheel_bodies().zip(&found) {
                let [fx, fy] = bearing.on_crank();
                sum = [sum[0] + fx, sum[1] + fy];
                loads[wheel].fx -= fx;
                loads[wheel].fy -= fy;
                loads[wheel].moment += bearing.load.drag_n_m - cross(bearing.arm, [fx, fy]);
            }
            let moment = Self::moment(&found);
            let [fx, fy] = self.with_mesh(sum, moment, &bodies[body]);
            loads[body].fx += fx;
            loads[body].fy += fy;
            loads[Layout::INPUT].moment -= self.teeth_ratio * moment;
        }
    }

    /// Force of a crank on the output, N: that of its bearings, and that of its planet's mesh under the crank's moment.
    fn with_mesh(
        &self,
        force: [f64; 2],
        moment: f64,
        &BodyState { x, y, .. }: &BodyState,
    ) -> [f64; 2] {
        let across = (1.0 + self.teeth_ratio) * moment / (x * x + y * y);
        [force[0] - across * y, force[1] + across * x]
    }

    /// Adds what they and the supports store, and what they lose.
    pub(crate) fn add_energy(&self, bodies: &[BodyState], sum: &mut ContactEnergy) {
        let mut found = OfCrank::new();
        for crank in 0..self.count() {
            let [x, y, turned] = self.crank(bodies, crank, &mut found);
            sum.stored_j += 0.5 * self.support.unwrap_or_default() * (x * x + y * y);
            sum.stored_j += 0.5 * self.mesh.unwrap_or_default() * turned * turned;
            for (wheel, bearing) in found.iter().enumerate() {
                bearing.load.add_energy(&self.law(wheel, crank), sum);
            }
        }
    }
}
