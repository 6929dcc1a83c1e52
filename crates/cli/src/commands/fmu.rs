//! `pinwheel fmu`: a scene as a co-simulation unit.

use std::path::Path;

use pinwheel::engines::external;
use pinwheel::fmu::{Imprint, Package, PackageError};

use crate::args::{FmuArgs, label};
use crate::failure::Failure;
use crate::folder::replace;
use crate::screen;

pub(crate) fn fmu(args: &FmuArgs) -> Result<(), Failure> {
    let gearbox = args.scene.load()?;
    let named = args.out.clone();
    let name = format!("{}.fmu", label(&args.scene.scene));
    let file = named.unwrap_or_else(|| Path::new("out").join(name));
    if file.extension().is_none_or(|ending| ending != "fmu") {
        return Err(Failure::input(format!(
            "--out {} does not end in .fmu; name the file to write",
            file.display()
        )));
    }
    let library = external::fmu_library().map_err(Failure::engine)?;
    let failed = |error: PackageError| match error {
        PackageError::Given(why) => Failure::input(why),
        PackageError::Unit(why) => Failure::engine(why),
    };
    let imprint = Imprint::here(args.author.as_deref()).map_err(failed)?;
    let package = Package::new(&gearbox, &library, imprint).map_err(failed)?;
    let bytes = package.bytes().map_err(failed)?;
    replace(&file, &bytes, &Package::is_ours)?;
    let written = serde_json::json!({
        "file": file,
        "bytes": bytes.len(),
        "guid": package.guid(),
        "platform": package.platform(),
        "variables": package.variables(),
        "method": package.method(),
    });
    screen::show_or_json(&written, || {
        format!(
            "unit    {0} ({1} variables, {2}, {3})\nnext    import {0} in a master of FMI 2.0 co-simulation: docs/fmu.md",
            file.display(),
            package.variables(),
            package.method(),
            package.platform()
        )
    })
}
