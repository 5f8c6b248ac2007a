//! Global illumination as an operator equation.
//!
//! ```text
//! L = E + T L          L = Σ_{k≥0} T^k E          T = K G   (propagate, then scatter)
//! ```
//!
//! The rendering equation (Kajiya 1986) is a Fredholm equation of the second kind. Its solution is the Neumann series. This
//! crate estimates every term `T^k E` separately. It compares their sum with a path tracer and with a radiosity matrix of
//! the same scene, and it states with error bars whether they agree.
//!
//! **k counts applications of T**: k = 0 is emission seen directly, k = 1 direct light, k = 2 one bounce of indirect light.
//! The terms k = 0..=K are estimated one by one, where K is the maximum number of bounces. The sum of all later terms is the
//! tail. **q is the probability of termination** in Russian roulette.
//!
//! **The symbols of the lecture, with the item and the file of each.** Estimators sample T with random paths. Solvers apply
//! T as a matrix to one radiance per patch.
//!
//! | symbol | meaning | item | file |
//! |---|---|---|---|
//! | x, ω | a surface point and the direction in which radiance leaves it | [`scene::Vertex`] | `scene/vertex.rs` |
//! | L | radiance, W·sr⁻¹·m⁻²: the solution | estimated with rays [`terms::Series`], solved with a matrix [`solver::Solution`] | `terms/series.rs`, `solver/radiosity.rs` |
//! | L_o(x, ω) | radiance that leaves x in direction ω; a state of a path is such a pair | [`operator::Transport::State`] | `operator/transport.rs` |
//! | L_i(x, ω_i) | radiance that arrives: L_o(x', −ω_i) at the first point x' that a ray from x hits | [`scene::Scene::look`] | `scene/mod.rs` |
//! | L_e = E | emission | [`operator::Transport::emission`] | `operator/transport.rs` |
//! | f(ω_o, ω_i) | BSDF, sr⁻¹ | [`scene::bsdf::Bsdf::eval`] | `scene/bsdf/` |
//! | cos θ | cosine between the sampled direction and the normal at x | [`operator::Factors::cos`] | `operator/kernel.rs` |
//! | K | local scattering: ∫ f L_i cos θ dω | [`scene::bsdf`] | `scene/bsdf/mod.rs` |
//! | G | propagation along rays: L_i from L_o | [`scene::Scene::look`] | `scene/mod.rs` |
//! | T = K G | one bounce, in a form that can be sampled | as one weight [`operator::Transport`], as separate factors [`operator::Kernel`] | `operator/transport.rs`, `operator/kernel.rs` |
//! | T_h = diag(ρ) F | one bounce, in a form that can be applied to a vector | [`operator::matrix::LinearOperator`] | `operator/matrix.rs` |
//! | T^k E | the k-th term; one random sample of it is X_k | [`estimator::SingleTerm`], [`estimator::Prefix`] | `estimator/single_term.rs`, `estimator/prefix.rs` |
//! | p_ω | density of a direction, sr⁻¹ | [`scene::bsdf::Bsdf::pdf`] | `scene/bsdf/mod.rs` |
//! | p_A | density of a point on a light, m⁻² | [`scene::Scene::light_density`] | `scene/mod.rs` |
//! | α | throughput of a path: Π f cos θ/(p (1 − q)) | `throughput` of [`estimator::Paths`] and in [`estimator::PathTracer::radiance`] | `estimator/paths.rs`, `estimator/path_tracer.rs` |
//! | q\[k\] | probability of termination at vertex k | [`estimator::Roulette::q`] | `estimator/roulette.rs` |
//! | w | weight of a sampling technique in multiple importance sampling | [`estimator::Technique`] | `estimator/technique.rs` |
//! | shade(x, ω) | L_e plus the light found from x | [`estimator::PathTracer::radiance`]; with N children [`estimator::Branching`] | `estimator/path_tracer.rs`, `estimator/branching.rs` |
//! | N | samples per pixel; also the number of children of a vertex | [`engine::Settings::spp`]; [`estimator::Branching::children`] | `engine/settings.rs`, `estimator/branching.rs` |
//! | γ | bound on the norm of T: ‖T^k E‖ ≤ γ^k ‖E‖ | guaranteed [`scene::Scene::max_albedo`], observed [`stats::observed_rate`] | `scene/mod.rs`, `stats/decay.rs` |
//! | ‖T^k E‖₁ | norm of the k-th term over all surfaces | [`study::surface`] | `study/surface.rs` |
//! | R | number of independent replicates; every standard error is computed from them | [`terms::TermFilm`] | `terms/film.rs` |
//!
//! Data flows in one direction through the modules, and so do imports: a module imports only from modules to its left.
//!
//! ```text
//! math → scene → terms → progress → operator → estimator | solver → guide → stats → engine → study → zoo → diagnosis → report
//! ```
//!
//! The following example solves one scene in two ways and compares the results:
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
