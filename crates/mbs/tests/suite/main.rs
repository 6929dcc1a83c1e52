//! The tests of this crate as one program: linking is most of what a small test costs.

mod bounds;
mod constraint_inverse;
mod etd_adams;
mod exponential;
mod formulations;
mod integrators;
mod jacobian;
mod lu;
mod mechanisms;
mod published;
mod published_andrews_angles;
mod published_mechanisms;
mod published_stiff;
mod rodas5p;
mod saddle_point;
mod segments;
mod sliding;
