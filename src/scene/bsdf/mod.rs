//! How a surface scatters: `f(ω → ω')`, in sr⁻¹, and ways to sample it.
//!
//! | kind | file |
//! |---|---|
//! | Lambertian | [`diffuse`] |

pub mod diffuse;
