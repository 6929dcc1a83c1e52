//! Conversion of joint angles of MuJoCo and exudyn to body states, and of contact loads to joint torques.
//!
//! Joint angles are relative to the carrier. A carried body's own torque also acts on its carrier's joint, which turns it,
//! and its force acts there with the arm's lever.

use std::sync::{Arc, Mutex};

use pinwheel_contact::Complex;

use super::law::{Law, locked};

/// Joint coordinate of a body and position of the body on its carrier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Index of the body's joint in the engine's arrays.
    pub coordinate: usize,
    /// Carrying body; `None`: the ground. Carriers are on the ground themselves.
    pub carrier: Option<usize>,
    /// Centre of the body on the carrier, m.
    pub offset: [f64; 2],
}

/// Addresses of a run's numbers in the engine, valid until it detaches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Addresses {
    /// Address of the mjData, or another one that is the run's alone.
    pub data: usize,
    /// Joint angles, `coordinates` doubles.
    pub qpos: usize,
    /// Joint rates.
    pub qvel: usize,
    /// Joint torques, to which contacts are added.
    pub qfrc_passive: usize,
    /// Two 64-bit counters: evaluations, and evaluations at another state than the previous one.
    pub counters: usize,
    /// Length of the arrays.
    pub coordinates: usize,
}

impl Addresses {
    /// True if each address is valid for doubles or 64-bit counters: not null, and aligned.
    pub fn are_sound(&self) -> bool {
        let Self {
            data,
            qpos,
            qvel,
            qfrc_passive,
            counters,
            coordinates: _,
        } = *self;
        data != 0
            && [qpos, qvel, qfrc_passive, counters]
                .iter()
                .all(|&address| address != 0 && address.is_multiple_of(align_of::<f64>()))
    }
}

/// Run of an engine with the contact law.
pub struct Attached {
    pub run: usize,
    pub addresses: Addresses,
    pub places: Vec<Place>,
    pub law: Arc<Law>,
    pub calls: u64,
    /// Angles and rates of the last evaluation.
    pub last: Vec<f64>,
    pub torques: Vec<f64>,
    pub states: Vec<f64>,
    pub loads: Vec<f64>,
}

/// Runs for which an engine may call back. The callback is process-wide: the data passed to it identify the run.
pub static ATTACHED: Mutex<Vec<Attached>> = Mutex::new(Vec::new());

/// Attaches a run for callbacks, and detaches earlier ones of the same law or data: freed memory is reused, so an earlier
/// run at that address is stale.
pub fn attach(run: Attached) {
    let mut attached = locked(&ATTACHED);
    attached.retain(|other| other.run != run.run && other.addresses.data != run.addresses.data);
    attached.push(run);
}

/// Detaches a run, whose addresses are then stale.
pub fn detach(run: usize) {
    locked(&ATTACHED).retain(|attached| attached.run != run);
}

/// Effects of a call of the callback.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Counted {
    pub evaluated: bool,
    pub moved: bool,
}

impl Attached {
    pub fn new(run: usize, addresses: Addresses, places: Vec<Place>, law: Arc<Law>) -> Self {
        let bodies = places.len();
        Self {
            run,
            addresses,
            places,
            law,
            calls: 0,
            last: Vec::new(),
            torques: vec![0.0; addresses.coordinates],
            states: vec![0.0; 6 * bodies],
            loads: vec![0.0; 3 * bodies],
        }
    }

    /// Adds the contact torques at joint angles `q` and rates `v` to `out`.
    pub fn add_torques(&mut self, q: &[f64], v: &[f64], out: &mut [f64]) -> Counted {
        let evaluated = self.calls.is_multiple_of(self.law.every);
        self.calls += 1;
        let mut moved = false;
        if evaluated {
            let now = || q.iter().chain(v);
            moved = !self.last.iter().eq(now());
            self.last.clear();
            self.last.extend(now());
            self.evaluate(q, v);
        }
        for (out, torque) in out.iter_mut().zip(&self.torques) {
            *out += torque;
        }
        Counted { evaluated, moved }
    }

    fn evaluate(&mut self, q: &[f64], v: &[f64]) {
        let absolute = |place: &Place, joints: &[f64]| {
            let carrier = place
                .carrier
                .map_or(0.0, |carrier| joints[self.places[carrier].coordinate]);
            joints[place.coordinate] + carrier
        };
        for (place, state) in self
            .places
            .iter()
            .zip(self.states.as_chunks_mut::<6>().0.iter_mut())
        {
            let (arm, rate) = arm(place, &self.places, q, v);
            let swing = arm.turned().scale(rate);
            *state = [
                arm.re,
                arm.im,
                absolute(place, q),
                swing.re,
                swing.im,
                absolute(place, v),
            ];
        }
        self.law.evaluate(&self.states, &mut self.loads);
        self.torques.fill(0.0);
        for (place, &[fx, fy, moment]) in self.places.iter().zip(self.loads.as_chunks::<3>().0) {
            self.torques[place.coordinate] += moment;
            if let Some(carrier) = place.carrier {
                let (arm, _) = arm(place, &self.places, q, v);
                self.torques[self.places[carrier].coordinate] +=
                    moment + arm.cross(Complex::new(fx, fy));
            }
        }
    }
}

/// Returns a body's arm on its carrier (or its position on the ground), m, in the ground frame, and the rate at which it
/// turns.
fn arm(place: &Place, places: &[Place], q: &[f64], v: &[f64]) -> (Complex, f64) {
    let offset = Complex::new(place.offset[0], place.offset[1]);
    match place.carrier {
        None => (offset, 0.0),
        Some(carrier) => {
            let joint = places[carrier].coordinate;
            (offset * Complex::unit(q[joint]), v[joint])
        }
    }
}
