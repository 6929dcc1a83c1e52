//! Macro that makes the laws from the lines of the registry.

macro_rules! registry {
    ($($module:ident: $law:ident($type:ty),)*) => {
        /// All laws.
        pub const LAWS: &[LawInfo] = &[$($module::INFO),*];

        /// Any law, told apart by one branch that is always taken the same way: loops over contacts are compiled once for
        /// all laws.
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[expect(missing_docs, reason = "the laws speak for themselves")]
        pub enum Law {
            $($law($type)),*
        }

        impl Law {
            /// The law called `name`, with what it reads of the parameters; `None` if there is none.
            #[must_use]
            pub fn named(name: &str, parameters: &LawParameters) -> Option<Self> {
                $(if name == $module::INFO.name {
                    return Some(Self::$law($module::new(parameters)));
                })*
                None
            }

            /// Facts of the law for users.
            #[must_use]
            pub fn info(&self) -> &'static LawInfo {
                match self {
                    $(Self::$law(_) => &$module::INFO),*
                }
            }
        }

        impl NormalLaw for Law {
            #[inline(always)]
            fn force<R: Real>(&self, stiffness: R, penetration: R, rate: R) -> R {
                match self {
                    $(Self::$law(law) => law.force(stiffness, penetration, rate)),*
                }
            }

            #[inline(always)]
            fn stored<R: Real>(&self, stiffness: R, penetration: R) -> R {
                match self {
                    $(Self::$law(law) => law.stored(stiffness, penetration)),*
                }
            }

            #[inline(always)]
            fn along<R: Real>(&self, stiffness: R, penetration: R) -> Option<R> {
                match self {
                    $(Self::$law(law) => law.along(stiffness, penetration)),*
                }
            }

            #[inline]
            fn stiffness(&self, hertz: f64) -> f64 {
                match self {
                    $(Self::$law(law) => law.stiffness(hertz)),*
                }
            }

            #[inline]
            fn exponent(&self) -> f64 {
                match self {
                    $(Self::$law(law) => law.exponent()),*
                }
            }

            fn elastic(&self, hertz: f64, depth: f64) -> f64 {
                match self {
                    $(Self::$law(law) => law.elastic(hertz, depth)),*
                }
            }

            fn depth(&self, hertz: f64, force: f64) -> f64 {
                match self {
                    $(Self::$law(law) => law.depth(hertz, force)),*
                }
            }

            fn tangent(&self, hertz: f64, depth: f64) -> f64 {
                match self {
                    $(Self::$law(law) => law.tangent(hertz, depth)),*
                }
            }

            #[inline(always)]
            fn observed<R: Real>(&self, stiffness: R, penetration: R, rate: R) -> [R; 3] {
                match self {
                    $(Self::$law(law) => law.observed(stiffness, penetration, rate)),*
                }
            }
        }
    };
}
pub(super) use registry;
