//! Recording of samples, and removal of the last one.

use pinwheel_gearbox::channels::{EngineState, LawPairs};
use pinwheel_gearbox::statics::Statics;
use pinwheel_gearbox::{Gearbox, Recorder};
use pinwheel_mbs::{Observation, Wrench};
use pinwheel_scene::{Layout, Scene};

/// Contact forces and pin loads give one sample, and the last sample can be removed.
#[test]
fn contacts_and_loads_are_recorded_alike() {
    let gearbox = Gearbox::new(&Scene::load("paper", &[]).unwrap()).unwrap();
    let bodies = Statics::new(&gearbox)
        .unwrap()
        .solve(0.3, 22.0)
        .unwrap()
        .bodies;
    let mut field = gearbox.contact_field().unwrap();
    let mut loads = vec![Wrench::default(); bodies.len()];
    field.add_loads(&bodies, &mut loads);
    let mut recorder = Recorder::new(&gearbox);
    assert!(recorder.is_empty());
    recorder.record(0.0, 1.0, &bodies, &mut field);
    let observation = Observation {
        time: 1.0,
        bodies: &bodies,
        loads: &loads,
        moments: None,
        kinetic_j: 0.0,
        driver_torques: &[],
        energy: None,
        reactions: None,
    };
    recorder.record_observed(&observation, [2.0, 0.0]);
    assert_eq!((recorder.len(), recorder.is_empty()), (2, false));
    let mut row = Vec::new();
    let time_series = recorder.clone().finish().unwrap();
    recorder.take_last(&mut row);
    assert_eq!(
        (recorder.len(), row.len()),
        (1, time_series.channels().len())
    );
    let most = time_series.channel("external_sleeve_force_n_3").unwrap()[0].max(22.0);
    for (channel, last) in time_series.channels().iter().zip(row) {
        let [of_contacts, of_loads] = channel.values[..] else {
            panic!("two samples")
        };
        assert_eq!(of_loads, last);
        let same = (of_contacts - of_loads).abs() <= 1e-12 * most;
        assert!(
            same || channel.name == "input_torque_n_m",
            "{}",
            channel.name
        );
    }
    assert!((time_series.channel("output_torque_n_m").unwrap()[0] + 22.0).abs() < 1e-6);
}

/// Channels beyond the contract are removed with the sample, after its columns.
#[test]
fn channels_are_taken_out_with_their_sample() {
    let mut scene = Scene::load("paper", &[]).unwrap().into_scene();
    scene.output.channels = vec!["input_power_w".into()];
    let gearbox = Gearbox::new(&scene.check().unwrap()).unwrap();
    let bodies = gearbox.initial_states();
    let mut field = gearbox.contact_field().unwrap();
    let mut recorder = Recorder::new(&gearbox);
    assert!(recorder.wants_channels());
    for torque in [1.0, 2.0] {
        recorder.record(torque, torque, &bodies, &mut field);
        recorder.record_channels(&mut EngineState {
            bodies: &bodies,
            driver_torque_n_m: torque,
            reactions: None,
            contacts: &mut LawPairs(&mut field),
        });
    }
    let (speed, columns) = (
        bodies[Layout::INPUT].rate,
        Recorder::contract(&gearbox).len(),
    );
    for torque in [2.0, 1.0] {
        let mut row = Vec::new();
        recorder.take_last(&mut row);
        assert_eq!((row.len(), row[columns]), (columns + 1, torque * speed));
    }
    assert!(recorder.is_empty());
    let plain = Gearbox::new(&Scene::load("paper", &[]).unwrap()).unwrap();
    assert!(!Recorder::new(&plain).wants_channels());
}
