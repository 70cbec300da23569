//! Tests of whole steps of the solver, in one program, since each that instantiates its kernels takes long to build.

mod allocations;
mod canopy_motion;
mod readme;
mod solids;
mod solids_limits;
