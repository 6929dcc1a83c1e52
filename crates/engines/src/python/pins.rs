//! The pinned packages of the Python engines, from the list of what we ask for.

/// A pinned package.
pub(super) struct Pin {
    pub(super) package: &'static str,
    pub(super) version: &'static str,
}

/// All of them.
pub(super) fn pins() -> impl Iterator<Item = Pin> {
    of(LIST)
}

/// What we ask for.
const LIST: &str = include_str!("../../../../python/requirements.in");

/// The pins of a list.
fn of(list: &'static str) -> impl Iterator<Item = Pin> {
    list.lines().filter_map(|line| {
        let (package, version) = line.split_once("==")?;
        (!package.starts_with('#')).then_some(Pin { package, version })
    })
}

/// Name and pinned version of a package of the engines.
pub(super) fn version(package: &str) -> String {
    pinned(LIST, package)
}

/// Name and version of a package as a list pins it.
pub(crate) fn pinned(list: &'static str, package: &str) -> String {
    let name = package.trim_end_matches("-core");
    of(list)
        .find(|pin| pin.package == package)
        .map_or_else(|| name.to_owned(), |pin| format!("{name} {}", pin.version))
}
