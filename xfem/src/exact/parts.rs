//! Parts of closed forms: frames, constants, potentials, springs.

pub mod contact_zone;
pub mod crack_field;
pub mod elliptic_disc;
pub mod elliptic_slip;
pub mod face_load;
pub mod jet;
pub mod line_crack;
pub mod one_dof;
