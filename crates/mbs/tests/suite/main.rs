//! Tests of this crate as one program, because linking dominates the cost of a small test.

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
