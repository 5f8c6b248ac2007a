//! The error of a mesh, as an allowance for verdicts.

use crate::terms::{Estimate, Functional, Series};

/// Returns |fine − coarse| of two meshes in one world, as an allowance. If the error falls at least as fast as the mesh
/// width h, the finer mesh is closer to the limit than the two meshes are to each other.
pub fn discretisation(fine: &Series, coarse: &Series) -> Vec<Functional> {
    let gap = |a: &Estimate, b: &Estimate| Estimate::exact((a.mean - b.mean).abs());
    let functional = |f: &Functional| {
        let c = coarse.functionals.iter().find(|c| c.name == f.name)?;
        Some(Functional {
            name: f.name.clone(),
            terms: f.terms.iter().zip(&c.terms).map(|(a, b)| gap(a, b)).collect(),
            tail: gap(&f.tail, &c.tail),
            sum: gap(&f.sum, &c.sum),
            total: gap(&f.total, &c.total),
        })
    };
    fine.functionals.iter().filter_map(functional).collect()
}
