//! What a mesh may still matter, as an allowance for verdicts.

use crate::terms::{Estimate, Functional, Series};

/// |fine − coarse| of two meshes of one world, as an allowance: where the error falls at least as fast as h, the finer
/// mesh is closer to the limit than the two are to each other.
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
