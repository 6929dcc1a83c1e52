//! What can go wrong in a study.

/// Why a study gave no result.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The observer asked to stop.
    #[error("stopped")]
    Cancelled,
    /// A scene that cannot be loaded.
    #[error(transparent)]
    Load(#[from] pinwheel_scene::SceneError),
    /// A scene that cannot be modelled.
    #[error("{scene}: {source}")]
    Scene {
        /// Its name.
        scene: String,
        /// Why.
        source: pinwheel_gearbox::GearboxError,
    },
    /// The run everything is compared with failed.
    #[error("{scene}: the reference run {reason}; use a scene that can be resolved")]
    Reference {
        /// Its name.
        scene: String,
        /// Why.
        reason: String,
    },
    /// An embedded table of published values is faulty.
    #[error("the published values cannot be read: {0}")]
    Published(String),
    /// A table could not be written.
    #[error("the table cannot be written: {0}")]
    Table(#[from] csv::Error),
    /// Recording failed.
    #[error(transparent)]
    Courses(#[from] pinwheel_courses::CoursesError),
}
