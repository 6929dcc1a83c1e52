//! Macro that generates the laws from the lines of the registry.

macro_rules! registry {
    (laws { $($module:ident: $form:ident,)* } forms { $($variant:ident($type:ty),)* }) => {
        /// All laws.
        pub const LAWS: &[LawInfo] = &[$($module::INFO),*];

        /// Constructors of the laws, in the order of [`LAWS`].
        const CONSTRUCTORS: &[fn(&LawParameters) -> Form] =
            &[$(|parameters| Form::$form($module::new(parameters))),*];

        /// Types of laws; several laws may share a type and differ in its constants.
        #[derive(Debug, Clone, Copy, PartialEq)]
        enum Form {
            $($variant($type)),*
        }

        /// Evaluates an expression for the type of a law.
        macro_rules! for_form {
            ($law:ident, $of:ident => $value:expr) => {
                match &$law.form {
                    $(Form::$variant($of) => $value),*
                }
            };
        }
    };
}
pub(super) use registry;
