//! Values that options take by name, each with one line on what it is: for help, for shell completions and for suggestions.

/// Names of values, each with its description.
pub type Choices = &'static [(&'static str, &'static str)];

/// How paths find light.
pub const TECHNIQUES: Choices = &[
    ("scatter", "BSDF sampling alone: a path must hit the light"),
    ("connect", "next-event estimation; after a mirror also hits, which no connection finds"),
    ("mis", "both, weighted by the balance heuristic"),
    ("mis-power", "both, weighted by the power heuristic"),
];

/// How a connection selects a light.
pub const LIGHTS: Choices =
    &[("uniform", "every light with the same probability"), ("power", "each light in proportion to its power")];

/// How directions are sampled.
pub const SAMPLINGS: Choices = &[
    ("uniform", "uniform over the hemisphere"),
    ("cosine", "in proportion to the cosine"),
    ("bsdf", "in proportion to the BSDF times the cosine, or nearly so"),
];

/// How the samples of a pixel are spread.
pub const POINTS: Choices = &[
    ("independent", "independent random numbers"),
    ("sobol", "Owen-scrambled Sobol points, with one scramble per replicate"),
];

/// What guides rays.
pub const GUIDES: Choices = &[
    ("bsdf", "no guide: the surface alone decides"),
    ("radiosity", "a radiosity solution of the scene says where light comes from"),
];

/// Estimators of the terms.
pub const ESTIMATORS: Choices = &[
    ("single", "each term from its own paths"),
    ("prefix", "all terms from the prefixes of one path"),
    ("branching", "a tree with --branching children at every vertex"),
    ("light", "particles that start at the lights"),
    ("bidirectional", "walks from both ends, joined in every way"),
];

/// Estimators of the terms, and the path tracer.
pub const CHECKED: Choices = &[
    ("single", "each term from its own paths"),
    ("prefix", "all terms from the prefixes of one path"),
    ("branching", "a tree with --branching children at every vertex"),
    ("light", "particles that start at the lights"),
    ("bidirectional", "walks from both ends, joined in every way"),
    ("path", "the path tracer: all terms in one sum"),
];

/// Walks on a matrix.
pub const WALKERS: Choices = &[
    ("single", "each term from its own walks"),
    ("prefix", "all terms from the prefixes of one walk"),
    ("branching", "a tree with --branching children at every vertex"),
    ("light", "particles that start at the emitting patches"),
    ("bidirectional", "walks from both ends, joined in every way"),
    ("path", "the path tracer: all terms in one sum"),
    ("absorption", "scored only where the walk ends"),
    ("zero-variance", "absorption guided by the solution itself, then by worse and worse guides"),
];

/// The three ways to solve a scene; this program calls each a world.
pub const WORLDS: Choices = &[
    ("terms", "each term by its own estimator"),
    ("path", "the full path tracer"),
    ("radiosity", "the matrix over patches"),
];

/// How form factors are held.
pub const FORMS: Choices = &[
    ("dense", "a full matrix, deterministic"),
    ("rays", "rows of stored rays, with an error bar"),
    ("both", "the matrix, and how far stored rays on the same patches are from it"),
];

/// Solvers of (I − T) L = E.
pub const SOLVERS: Choices = &[
    ("all", "all of them, compared"),
    ("neumann", "partial sums of Σ TᵏE"),
    ("jacobi", "the same as neumann unless a patch sees itself"),
    ("gauss-seidel", "patch by patch"),
    ("sor", "patch by patch, over-relaxed"),
    ("southwell", "progressive shooting, the brightest patch first"),
    ("chebyshev", "needs the ends of the spectrum, and estimates them first"),
    ("cg", "conjugate gradients, in the inner product with weight 1/ρ; needs a dense matrix"),
    ("gmres", "the smallest residual in a Krylov space"),
    ("lu", "the direct solution, the reference for all others; needs a dense matrix"),
];

/// Colour channels.
pub const CHANNELS: Choices = &[("red", ""), ("green", ""), ("blue", "")];

/// The names alone.
pub fn names(choices: Choices) -> Vec<&'static str> {
    choices.iter().map(|c| c.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fredholm::engine::by_rays::Estimator;
    use fredholm::engine::discretisation::Form;
    use fredholm::engine::guided::Guiding;
    use fredholm::estimator::Technique;
    use fredholm::math::Points;
    use fredholm::scene::{Selection, bsdf::Sampling};
    use fredholm::solver::comparison::Solvers;
    use fredholm::study::walk::Study;
    use fredholm::terms::{Channel, World};

    #[test]
    fn every_value_of_the_library_has_a_line() {
        fn check<T: ToString>(all: impl IntoIterator<Item = T>, choices: Choices) {
            let mut have = names(choices);
            let mut all: Vec<String> = all.into_iter().map(|v| v.to_string()).collect();
            have.sort_unstable();
            all.sort_unstable();
            assert_eq!(all, have);
        }
        check(Technique::ALL, TECHNIQUES);
        check(Selection::ALL, LIGHTS);
        check(Sampling::ALL, SAMPLINGS);
        check(Points::ALL, POINTS);
        check(Guiding::ALL, GUIDES);
        check(Estimator::ALL.map(Estimator::name), ESTIMATORS);
        check(Estimator::ALL.map(Estimator::name).into_iter().chain(["path"]), CHECKED);
        check(Study::all().into_iter().map(Study::name), WALKERS);
        check(World::ALL, WORLDS);
        check(Form::ALL, FORMS);
        check(Solvers::choices(), SOLVERS);
        check(Channel::ALL, CHANNELS);
    }
}
