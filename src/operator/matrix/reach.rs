//! The patches that light reaches, found by a search through the graph of T.
//!
//! ```text
//! R₀ = supp E,    Rₙ₊₁ = Rₙ ∪ { i : Tᵢⱼ > 0 for some j in Rₙ },    R = ∪ Rₙ = supp L
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | sends | patches that send light: they emit, or light reaches them and they reflect it | `sends` |
//! | R | patches that emit light or that light reaches | [`reached`] |
//!
//! Outside R the solution is 0, whatever T does there. A part of the scene that light never reaches may have a reflectance
//! of 1: then I − T is singular there, and the spectral radius r(T) is not the rate at which the terms decay. Restricted to
//! R, I − T and r(T) describe the light that exists.

use rayon::prelude::*;

/// For each of `n` patches, whether light reaches it. The function `sees(i, sends)` tells whether patch i sees any patch
/// that sends light.
///
/// ```
/// use fredholm::operator::matrix::reached;
/// // 0 and 1 see each other, and so do 2 and 3; only 0 emits
/// let sees = |i: usize, sends: &[bool]| sends[i ^ 1];
/// assert_eq!(reached(4, |i| i == 0, |_| true, sees), [true, true, false, false]);
/// ```
pub fn reached(
    n: usize,
    emits: impl Fn(usize) -> bool,
    reflects: impl Fn(usize) -> bool,
    sees: impl Fn(usize, &[bool]) -> bool + Sync,
) -> Vec<bool> {
    let mut lit: Vec<bool> = (0..n).map(&emits).collect();
    let mut sends = lit.clone();
    loop {
        let new: Vec<usize> = (0..n).into_par_iter().filter(|&i| !lit[i] && sees(i, &sends)).collect();
        if new.is_empty() {
            return lit;
        }
        for i in new {
            lit[i] = true;
            sends[i] = reflects(i);
        }
    }
}
