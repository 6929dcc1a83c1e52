//! Dynamics of cycloidal gearboxes by several engines, compared: the library in one piece.

pub use pinwheel_compare as compare;
pub use pinwheel_contact as contact;
pub use pinwheel_courses as courses;
pub use pinwheel_engines as engines;
pub use pinwheel_gearbox as gearbox;
pub use pinwheel_mbs as mbs;
pub use pinwheel_pages as pages;
pub use pinwheel_report as report;
pub use pinwheel_scene as scene;
pub use pinwheel_studies as studies;
