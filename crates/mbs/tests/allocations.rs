//! Stepping allocates no memory, for every method and both formulations.

use pinwheel_mbs::integrators::{METHODS, StepSettings, Stepper, start};
use pinwheel_mbs::{
    Body, BodyState, Detail, Driver, Evaluation, Forces, Formulation, Lagrange, Mechanism, Motion,
    Reduced, Revolute, Stabilisation, Variable, Wrench,
};

/// Springs on every angle.
struct Springs;

impl Forces for Springs {
    fn apply(&mut self, _: f64, bodies: &[BodyState], loads: &mut [Wrench]) {
        for (load, body) in loads.iter_mut().zip(bodies) {
            load.moment -= body.angle;
            load.fx += 0.1 * body.angle;
        }
    }

    /// Approximate: methods that request derivatives must use them.
    fn have_derivatives(&self) -> bool {
        true
    }

    fn evaluate(&mut self, t: f64, bodies: &[BodyState], request: &mut Evaluation<'_>) {
        if let Some(loads) = &mut request.loads {
            self.apply(t, bodies, loads);
        }
        if let Some(derivatives) = &mut request.derivatives {
            for (body, _) in bodies.iter().enumerate() {
                let row = derivatives.coordinates.angle(body);
                let own = row.map(Variable::Position);
                derivatives.add(row, own.as_slice(), &[-1.0]);
            }
        }
    }
}

/// Returns a mechanism of a driven and a free hub, each with bodies at their centres of mass.
fn mechanism() -> Mechanism {
    let body = |k: usize| Body {
        name: format!("body {k}"),
        mass: 1.0,
        moment: 0.1,
        start: BodyState {
            rate: 1.0,
            ..BodyState::default()
        },
    };
    let pin = |parent, parent_point, child| Revolute {
        parent,
        parent_point,
        child,
        child_point: [0.0; 2],
    };
    Mechanism {
        bodies: (0..6).map(body).collect(),
        revolutes: vec![
            pin(None, [0.0; 2], 0),
            pin(None, [0.0; 2], 1),
            pin(Some(0), [0.1, 0.0], 2),
            pin(Some(1), [0.2, 0.0], 3),
            pin(Some(1), [-0.2, 0.0], 4),
            pin(None, [1.0, 0.0], 5),
        ],
        drivers: vec![Driver {
            parent: None,
            child: 0,
            motion: Motion {
                from_s: 0.0,
                angle: 0.0,
                rate: 1.0,
                acceleration: 0.0,
            },
            ..Driver::default()
        }],
    }
}

/// Counts the allocations of 500 steps after the first ten.
fn allocations<F: Formulation>(method: &str, mut system: F) -> u64 {
    let mut y = system.initial();
    let settings = StepSettings {
        step: 1e-3,
        tolerance: 1e-6,
    };
    let mut run: Box<dyn Stepper> = start(method, settings, 0.0, &y).unwrap();
    for _ in 0..10 {
        run.step(&mut system).unwrap();
    }
    let counted = allocation_counter::measure(|| {
        for _ in 0..500 {
            run.step(&mut system).unwrap();
            let t = run.time();
            run.interpolate(&mut system, t, &mut y);
            system.observe(t, &y, Detail::Everything);
        }
    });
    counted.count_total
}

#[test]
fn the_counter_counts() {
    let counted = allocation_counter::measure(|| drop(std::hint::black_box(vec![1_u8; 10])));
    assert_eq!(counted.count_total, 1);
}

#[test]
fn stepping_allocates_nothing() {
    for method in METHODS {
        let reduced = Reduced::new(mechanism(), Springs, &[]).unwrap();
        assert_eq!(
            allocations(method.name, reduced),
            0,
            "{}, reduced",
            method.name
        );
        for stabilisation in [Stabilisation::None, Stabilisation::Projection] {
            let lagrange = Lagrange::new(mechanism(), Springs, stabilisation).unwrap();
            let count = allocations(method.name, lagrange);
            assert_eq!(count, 0, "{}, {stabilisation:?}", method.name);
        }
    }
}
