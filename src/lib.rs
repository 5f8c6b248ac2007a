//! The operator view of global illumination.
//!
//! ```text
//! L = E + T L          L = Σ_{k≥0} T^k E          T = K G   (propagate, then scatter)
//! ```
//!
//! The rendering equation (Kajiya 1986) is a Fredholm equation of the second kind, and its solution is the Neumann series. This
//! crate estimates every term `T^k E` on its own, compares their sum with a path tracer and with a radiosity matrix of the same
//! scene, and says with error bars whether they agree.
//!
//! **k counts applications of T**: k = 0 is emission seen directly, k = 1 direct light, k = 2 one bounce of indirect light. K keeps
//! k = 0..=K, and everything longer is the tail. **q is the probability of termination.**
//!
//! | notation | meaning | place |
//! |---|---|---|
//! | x, ω | a surface point and the direction radiance leaves in | [`scene::Vertex`] |
//! | E | emitted radiance, W·sr⁻¹·m⁻² | [`operator::Transport::emission`] |
//! | T, sampled | rays in a scene, or a walk on a matrix | [`operator::Transport`] |
//! | T_h = diag(ρ) F, applied | the matrix over patches | [`operator::matrix::LinearOperator`] |
//! | `X_k`, E\[X_k\] = (T^k E)(x) | one sample of a term | [`estimator::TermEstimator`] |
//! | R | independent replicates, the unit of every error | [`terms::TermFilm`] |
//! | ‖T^k E‖₁ | over all surfaces | [`study::surface`] |
//! | α, δ | level and margin of a verdict | [`stats::Criterion`] |
//!
//! Data flows one way, and so do imports:
//!
//! ```text
//! math → scene → terms → progress → operator → estimator | solver → guide → stats → engine → study → zoo → diagnosis → report
//! ```
//!
//! One scene, solved two ways, in a few lines:
//!
//! ```
//! use fredholm::scene::{Scene, load};
//! use fredholm::stats::{Criterion, Outcome, compare};
//! use fredholm::progress::Progress;
//! use fredholm::engine::{Settings, by_rays};
//!
//! let options = load::Options { set: vec!["camera.size=[8,8]".into()], ..Default::default() };
//! let scene = Scene::new(&load::scene("furnace", &options)?.description);
//! let settings = Settings { spp: 64, ..Settings::default() };
//! let terms = by_rays::terms(&scene, by_rays::Estimator::Prefix, &settings, Progress::NONE);
//! let path = by_rays::path(&scene, &settings, Progress::NONE);
//! assert_ne!(compare(&terms.series, &path.series, &Criterion::default(), &[]).outcome, Outcome::Differs);
//! # Ok::<(), fredholm::scene::SceneError>(())
//! ```

pub mod diagnosis;
pub mod engine;
pub mod estimator;
pub mod guide;
pub mod math;
pub mod operator;
pub mod progress;
pub mod report;
pub mod scene;
pub mod solver;
pub mod stats;
pub mod study;
pub mod terms;
pub mod zoo;
