//! Friction of the sleeves for methods that treat it implicitly: which contacts there are, as data
//! for [`pinwheel_mbs::sliding`].

mod forces;

pub(crate) use forces::GearForces;
