//! `pinwheel fmu`: a scene as a co-simulation unit.

use std::path::Path;

use pinwheel::engines::external;
use pinwheel::fmu::{Package, PackageError};
use pinwheel::studies::output::file_name;

use crate::args::FmuArgs;
use crate::failure::Failure;
use crate::folder::replace;
use crate::screen;

pub(crate) fn fmu(args: &FmuArgs) -> Result<(), Failure> {
    let gearbox = args.scene.load()?;
    let named = args.out.clone();
    let file = named.unwrap_or_else(|| {
        Path::new("out").join(format!("{}.fmu", file_name(&gearbox.scene.name)))
    });
    if file.extension().is_none_or(|ending| ending != "fmu") {
        return Err(Failure::input(format!(
            "--out {} does not end in .fmu; name the file to write",
            file.display()
        )));
    }
    let library = external::fmu_library().map_err(Failure::engine)?;
    let package = Package::new(&gearbox, &library).map_err(|error| match error {
        PackageError::Scene(_) => Failure::input(error.to_string()),
        _ => Failure::engine(error.to_string()),
    })?;
    let bytes = package
        .bytes()
        .map_err(|error| Failure::engine(error.to_string()))?;
    replace(&file, &bytes)?;
    let told = serde_json::json!({
        "file": file,
        "bytes": bytes.len(),
        "guid": package.guid(),
        "platform": package.platform(),
        "variables": package.variables(),
        "method": package.method(),
    });
    screen::show_or_json(args.json, &told, || {
        format!(
            "unit    {0} ({1} variables, {2}, {3})\nnext    import {0} in a master of FMI 2.0 co-simulation: docs/fmu.md",
            file.display(),
            package.variables(),
            package.method(),
            package.platform()
        )
    })
}
