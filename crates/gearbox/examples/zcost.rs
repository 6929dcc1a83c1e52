use pinwheel_gearbox::{Gearbox, auto, native};
use pinwheel_scene::{Override, Scene};
fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let scene = &args[0];
    let methods: Vec<&str> = args[1].split(',').collect();
    let sets: Vec<Override> = args[2..]
        .iter()
        .map(|a| {
            let (k, v) = a.split_once('=').unwrap();
            Override::new(k, v)
        })
        .collect();
    let load = |more: &[(&str, &str)]| {
        let mut all = sets.clone();
        all.extend(more.iter().map(|(k, v)| Override::new(*k, *v)));
        Gearbox::new(&Scene::load(scene, &all).unwrap()).unwrap()
    };
    let reference = if std::env::var("NOREF").is_ok() {
        None
    } else {
        let truth = std::env::var("TRUTH").unwrap_or("dop853:1e-11".into());
        let (m, t) = truth.split_once(':').unwrap();
        Some(
            native::run(
                &load(&[("solver.integrator", m), ("solver.tolerance", t)]),
                &mut |_| false,
            )
            .unwrap(),
        )
    };
    for m in methods {
        let (name, tol) = m.split_once(':').unwrap_or((m, ""));
        let mut more = vec![("solver.integrator", name)];
        if !tol.is_empty() {
            more.push(("solver.tolerance", tol));
        }
        let g = load(&more);
        let run = native::run(&g, &mut |_| false).unwrap();
        let d = reference
            .as_ref()
            .map(|r| g.distance(&run.time_series, &r.time_series));
        let plan = auto::plan(&g.scene, auto::TARGET);
        println!(
            "{scene} {m}: {:?} {:?} dist {:?} [plan {} {:.1e} longest {:.1e}]",
            run.counts, run.ending, d, plan.integrator, plan.tolerance, plan.longest_step_s
        );
    }
}
