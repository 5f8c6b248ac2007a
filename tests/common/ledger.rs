//! The only place where the significance of tests lives.
//!
//! ```text
//! P(some test of a full run fails by chance) ≤ n · share ≤ (1 − RESERVE) SUITE_ALPHA
//! level of one comparison = share / m
//! ```
//!
//! | symbol | meaning | place |
//! |---|---|---|
//! | SUITE_ALPHA | false alarms per full run, ignored tests included | [`SUITE_ALPHA`] |
//! | n | statistical tests of the project | [`ENTRIES`] |
//! | share | what one test may spend, the same for all | [`SHARE`] |
//! | m | how many scalars it compares (three per RGB value) | [`Entry::comparisons`] |
//! | t* | critical value of one comparison | [`Entry::threshold`] |
//!
//! Bonferroni inside a test and between tests; no independence is needed. A suite of a hundred tests at 1 % each would
//! raise a false alarm in 63 % of the runs with fresh seeds; fixed seeds only hide that until some innocent change
//! rolls the dice again.
//!
//! Nobody sets a share. The budget is cut into places, 64 at a time, with at least [`RESERVE`] of them empty: a new
//! test takes an empty place and leaves the thresholds of the others as they are. When the reserve would be touched, 64
//! more places shrink every share; from 192 to 256 places t* grows by less than 0.06.
//!
//! **To add a statistical test**, add a line to [`ENTRIES`] (the name is the test function's, so that the replay line
//! works; three comparisons for every RGB value that it will judge), then:
//!
//! ```ignore
//! let mut account = common::open("the_name_of_the_test");
//! let rng_seed = account.seed();
//! account.assert_equivalent("T1", &measured, DVec3::ONE, DVec3::splat(0.01));
//! ```
//!
//! `tests/ledger.rs` checks that the shares stay within the budget and that every entry belongs to a test.
//!
//! A test of *equivalence* fails by chance only if its noise is too large for δ: plan se ≤ δ / (t* + z_β) with
//! [`fredholm::stats::needed_samples`]. The failure message says whether the values differ or the noise hides the
//! answer; the cure of the second is samples, never a larger δ or another seed.

use fredholm::math::fnv1a;
use fredholm::stats::hypothesis::{Measured, ROUNDING, critical};
use fredholm::terms::Estimate;
use glam::DVec3;

/// Chance of a false alarm in one full run of the tests.
pub const SUITE_ALPHA: f64 = 1e-6;

/// The part of [`SUITE_ALPHA`] that nobody spends.
pub const RESERVE: f64 = 1.0 / 5.0;

/// What one test may spend.
pub const SHARE: f64 = share_among(ENTRIES.len());

/// The share of each of `tests`: the budget over the least multiple of 64 places of which a fifth stays empty.
pub const fn share_among(tests: usize) -> f64 {
    SUITE_ALPHA / ((5 * tests).div_ceil(4 * 64) * 64) as f64
}

/// A test and what it does with its [`SHARE`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Name of the test function.
    pub name: &'static str,
    /// Scalar comparisons it makes.
    pub comparisons: u32,
}

const fn entry(name: &'static str, comparisons: u32) -> Entry {
    Entry { name, comparisons }
}

/// Every statistical test of the project.
pub const ENTRIES: &[Entry] = &[
    entry("example_of_the_ledger", 3),
    // tests/statistics.rs
    entry("null_families_are_rejected_at_alpha", 4),
    entry("true_effects_do_not_raise_false_alarms_elsewhere", 1),
    entry("p_values_are_uniform_without_an_effect", 8),
    entry("a_shift_of_three_percent_is_found", 1),
    entry("the_planned_power_is_reached", 2),
    entry("rates_have_the_error_they_claim", 4),
    entry("variance_slopes_have_the_error_they_claim", 2),
    // tests/growth.rs
    entry("exponents_have_the_error_they_claim", 12),
    // tests/evidence.rs
    entry("few_samples_never_tell_equal_estimators_apart", 1),
    entry("intervals_cover_where_they_are_shown", 1),
    entry("shipped_scenes_do_not_differ_from_themselves", 1),
    // tests/sequential.rs
    entry("watching_raises_no_false_alarms", 6),
    entry("a_bias_is_found_after_the_planned_batches", 3),
    entry("watching_renders_raises_no_false_alarms", 2),
    entry("a_bias_of_one_percent_is_found_in_renders", 2),
    entry("watching_the_cornell_box_raises_no_false_alarms", 1),
    // tests/calibration.rs
    entry("the_fast_suite_passes", 64),
    entry("p_values_are_uniform_over_fresh_seeds", 64),
    entry("every_term_that_is_one_percent_off_is_found", 6),
    entry("half_a_percent_on_any_term_is_found", 6),
    // tests/equilibrium.rs
    entry("both_sides_are_the_solution_on_a_matrix", 72),
    entry("the_equation_holds_and_a_wrong_step_is_found", 9),
    // tests/absorption.rs
    entry("absorption_has_the_powers_of_the_matrix", 600),
    entry("absorption_and_collision_agree_in_any_scene", 300),
    entry("absorption_in_a_furnace_has_its_variance", 30),
    // tests/matrix_walk.rs
    entry("estimators_match_a_random_substochastic_matrix", 12_000),
    entry("estimators_match_two_plates", 4_000),
    entry("estimators_match_concentric_spheres", 4_000),
    entry("estimators_match_a_matrix_with_absorbing_rows", 7_000),
    entry("estimators_match_a_matrix_with_a_single_emitter", 7_000),
    entry("estimators_match_matrices_at_length", 12_000),
    entry("variances_follow_the_recursion_of_second_moments", 144),
    entry("a_small_error_in_the_operator_is_seen", 9),
    // tests/convergence.rs
    entry("slopes_of_renders_cover_minus_one", 4),
    entry("sobol_points_fall_faster_in_a_smooth_scene", 2),
    entry("squared_errors_are_unbiased", 4),
    // tests/split.rs
    entry("splits_cost_what_the_covariance_says", 30),
    entry("the_film_knows_the_covariance_of_its_terms", 100),
    // tests/acceleration.rs
    entry("accelerated_series_are_as_noisy_as_predicted", 12),
    // tests/adjoint.rs
    entry("light_tracing_matches_matrix_powers", 200),
    entry("bidirectional_matches_matrix_powers", 200),
    // tests/walk.rs
    entry("any_guide_keeps_the_mean", 405),
    entry("led_walks_have_their_variance", 81),
    // tests/identities.rs
    entry("a_scene_scaled_by_ten_has_the_same_terms", 72),
    // tests/geometry.rs
    entry("a_small_lamp_keeps_its_size_beside_any_ground", 12),
    entry("needles_and_strips_light_what_they_should", 100),
    entry("a_camera_may_stand_far_away", 30),
    entry("a_glowing_sphere_is_seen_from_inside_and_from_beside", 36),
    // tests/truth_scenes.rs
    entry("furnaces_have_their_terms_with_every_technique", 1_000),
    entry("spheres_of_bands_have_their_terms", 2_000),
    entry("bowls_have_their_terms_at_every_point", 1_000),
    entry("concentric_spheres_have_their_terms", 1_000),
    entry("eccentric_spheres_keep_the_area_mean_of_one_bounce", 18),
    entry("direct_light_is_the_closed_form", 200),
    entry("glowing_faces_of_a_cube_have_their_terms", 5_000),
    entry("a_cube_with_a_patch_light_has_its_terms", 3_000),
    entry("roulette_in_a_furnace_has_its_variance", 100),
    entry("roulette_on_a_sphere_has_its_variance", 18),
    entry("terms_of_one_path_have_their_covariance", 300),
    entry("roulette_and_uniform_directions_have_their_variance_term_by_term", 100),
    // tests/lights.rs
    entry("skies_are_sampled_as_their_density_says", 9),
    entry("skies_give_their_mean", 48),
    entry("a_quadratic_sky_lights_a_surface_in_closed_form", 15),
    entry("spheres_are_sampled_uniformly_in_solid_angle", 7),
    entry("a_sphere_above_the_horizon_is_a_point_light", 18),
    // tests/roulette.rs
    entry("no_term_moves_under_roulette", 75),
    // tests/schedules.rs
    entry("recorded_moments_are_those_of_the_matrix", 120),
    entry("predicted_variances_are_measured", 36),
    entry("predicted_variances_are_measured_at_length", 378),
    entry("predicted_variances_of_later_terms_are_measured", 15),
    entry("the_best_schedule_is_the_most_efficient", 11),
    // tests/points.rs
    entry("sobol_points_move_no_mean", 2_000),
    entry("errors_from_replicates_cover_the_truth", 1),
    entry("the_variance_of_a_smooth_integrand_falls_faster", 2),
    entry("no_term_of_a_furnace_is_noisier", 12),
    // tests/branching.rs
    entry("a_tree_has_the_powers_of_the_matrix", 2_000),
    entry("variances_follow_the_recursion_of_independent_children", 108),
    // tests/combinations.rs
    entry("every_pair_of_choices_has_the_same_terms", 60_000),
    entry("every_combination_has_the_same_terms", 600_000),
    entry("every_broken_emission_rule_is_found", 60_000),
    entry("a_strategy_that_counts_too_much_is_found", 2_000),
    // tests/scene_properties.rs
    entry("no_bounce_gains_energy", 768),
    entry("a_uniform_room_keeps_the_share_of_its_albedo", 144),
    entry("terms_do_not_depend_on_the_axes", 45),
    // tests/other_renderer.rs
    entry("terms_are_those_of_another_renderer", 1_050),
    entry("a_scene_that_is_a_little_wrong_is_told_apart", 9),
    // tests/coplanar.rs
    entry("lamps_in_a_plane_are_worth_their_light", 174),
    entry("lamps_in_a_plane_far_away", 54),
    entry("what_a_lamp_covers_sends_no_light", 9),
    // tests/light_and_surface_truths.rs
    entry("direct_light_is_the_closed_form_from_both_ends", 300),
    entry("a_mirror_wall_doubles_the_light", 200),
    entry("glass_in_a_white_furnace_has_its_terms", 500),
    entry("bidirectional_sees_glass", 100),
    entry("glass_disappears_in_a_furnace", 60),
    entry("convex_bodies_show_their_albedo", 500),
    entry("bodies_reflect_their_share_of_the_sky", 100),
    entry("bowls_under_the_sky_have_their_terms", 300),
    // tests/material_properties.rs
    entry("all_estimators_agree_in_any_scene", 2_000),
    entry("means_do_not_depend_on_the_axes", 600),
    entry("no_material_gains_energy", 480),
    entry("two_patches_may_change_places", 180),
    // tests/zoo.rs
    entry("members_have_their_closed_form", 200),
    entry("members_have_their_signature", 400),
    entry("every_member_is_rejected_and_the_right_walk_is_not", 100),
    entry("constants_are_rejected_in_199_of_200_runs", 1),
    entry("roulette_are_rejected_in_199_of_200_runs", 1),
    entry("measures_are_rejected_in_199_of_200_runs", 1),
    entry("directions_are_rejected_in_199_of_200_runs", 1),
    entry("shares_are_rejected_in_199_of_200_runs", 1),
    entry("lights_are_rejected_in_199_of_200_runs", 1),
    entry("specular_are_rejected_in_199_of_200_runs", 1),
    entry("bookkeeping_are_rejected_in_199_of_200_runs", 1),
    // tests/long_series.rs
    entry("a_thousand_bounces_have_their_closed_form", 6),
    entry("albedo_one_with_a_hole_has_its_closed_form", 12),
    // tests/rays.rs
    entry("rows_agree_with_the_matrix", 5_000),
    // tests/bsdf.rs
    entry("directions_have_the_density_they_claim", 1_000),
    entry("a_million_directions_have_the_density_they_claim", 1_000),
    entry("wrong_densities_are_found", 25),
    entry("weights_average_to_the_albedo", 3_000),
    entry("a_million_weights_average_to_the_albedo", 3_000),
    // tests/guided.rs
    entry("guided_directions_have_the_density_they_claim", 100),
    entry("a_guide_that_nobody_accounts_for_is_found", 12),
    entry("guided_terms_agree_with_the_others", 432),
    entry("guided_terms_agree_closely", 100),
    entry("guided_walks_have_the_terms_of_a_furnace", 200),
    // tests/diagnosis.rs
    entry("right_renderers_are_called_correct", 44),
    entry("false_alarms_keep_their_level", 2),
    entry("a_bias_of_the_size_that_is_promised_is_seen", 1),
    entry("strangers_are_named_from_layers", 11),
    entry("strangers_are_named_from_images", 9),
    entry("all_strangers_are_named_or_honestly_unnamed", 120),
    entry("correct_strangers_are_not_accused", 1),
    entry("two_hundred_correct_strangers_are_not_accused", 1),
    entry("an_unknown_curve_is_said_to_be_unknown", 2),
    entry("the_strip_of_whole_pictures_has_the_means_of_the_image", 9),
    entry("the_surfaces_add_up_to_the_norm_over_all_surfaces", 15),
];

impl Entry {
    /// Two-sided level of one of its comparisons.
    pub fn level(&self) -> f64 {
        SHARE / f64::from(self.comparisons)
    }

    /// Critical value of one comparison whose standard error has `dof` degrees of freedom (∞: the normal quantile).
    pub fn threshold(&self, dof: f64) -> f64 {
        critical(self.level(), dof)
    }
}

/// The entry of a test.
///
/// # Panics
/// If the test is not declared: an undeclared test would spend significance that nobody counts.
pub fn share(name: &str) -> &'static Entry {
    let found = ENTRIES.iter().find(|e| e.name == name);
    found.unwrap_or_else(|| panic!("`{name}` is not in the ledger: add it to ENTRIES in tests/common/ledger.rs"))
}

/// Opens the account of a test. `base_seed` is 0 unless the run asks for fresh seeds.
///
/// # Panics
/// If the test is not declared.
pub fn open(name: &str, base_seed: u64) -> Account {
    Account { entry: *share(name), base_seed, spent: 0 }
}

/// A test at work: it counts its comparisons and stops at the declared number.
#[derive(Debug)]
pub struct Account {
    entry: Entry,
    base_seed: u64,
    spent: u32,
}

impl Account {
    /// The seed of this test: its own, so that no other test can shift its numbers. FNV-1a of the name, then of the
    /// base seed.
    pub fn seed(&self) -> u64 {
        let bytes = self.entry.name.bytes().chain(self.base_seed.to_le_bytes());
        fnv1a(bytes)
    }

    /// Takes `n` comparisons from the account and returns the level of each.
    ///
    /// # Panics
    /// If the test declared fewer.
    pub fn spend(&mut self, n: u32) -> f64 {
        self.spent += n;
        let Entry { name, comparisons, .. } = self.entry;
        assert!(self.spent <= comparisons, "`{name}` makes more than the {comparisons} comparisons it declared");
        self.entry.level()
    }

    /// Passes only if `estimate` lies within ±`delta` of `truth` in every channel, with its whole interval at the
    /// ledger's level. `delta` is absolute: `truth * 0.01` for one percent.
    ///
    /// # Panics
    /// If not; the message tells a difference from a lack of samples.
    #[track_caller]
    pub fn assert_equivalent(&mut self, what: &str, estimate: &Estimate, truth: DVec3, delta: DVec3) {
        self.each_channel(what, estimate, truth, |m, half, c| {
            let effect = (m.mean - truth[c]).abs();
            if effect + half <= delta[c] {
                Ok(())
            } else if effect > half {
                Err(format!("differs (δ = {:.6e})", delta[c]))
            } else {
                let factor = (2.0 * half / delta[c]).powi(2);
                Err(format!("noise hides δ = {:.6e}: needs {factor:.1} times the samples", delta[c]))
            }
        });
    }

    /// Passes if the interval of `estimate` at the ledger's level contains `truth`, up to [`ROUNDING`]. It says nothing
    /// about the size of a difference that it did not find: prefer [`Account::assert_equivalent`].
    ///
    /// # Panics
    /// If not.
    #[track_caller]
    pub fn assert_consistent(&mut self, what: &str, estimate: &Estimate, truth: DVec3) {
        self.each_channel(what, estimate, truth, |m, half, c| {
            let inside = (m.mean - truth[c]).abs() <= half + ROUNDING * truth[c].abs();
            if inside { Ok(()) } else { Err("differs".into()) }
        });
    }

    /// Passes if `estimate` is told apart from `truth` in at least one channel: the proof that a test can see a bug. It
    /// fails by chance with the power it lacks, so plan for β ≤ the level.
    ///
    /// # Panics
    /// If the difference is not seen.
    #[track_caller]
    pub fn assert_differs(&mut self, what: &str, estimate: &Estimate, truth: DVec3) {
        let level = self.spend(3);
        let seen = (0..3).any(|c| {
            let m = Measured::of(estimate, c);
            (m.mean - truth[c]).abs() > half_width(m, level) + ROUNDING * truth[c].abs()
        });
        assert!(seen, "{}", self.message(what, "is not told apart", estimate, truth));
    }

    #[track_caller]
    fn each_channel(
        &mut self,
        what: &str,
        estimate: &Estimate,
        truth: DVec3,
        judge: impl Fn(Measured, f64, usize) -> Result<(), String>,
    ) {
        let level = self.spend(3);
        for c in 0..3 {
            let m = Measured::of(estimate, c);
            if let Err(verdict) = judge(m, half_width(m, level), c) {
                let channel = ["red", "green", "blue"][c];
                panic!("{}", self.message(&format!("{what}, {channel}"), &verdict, estimate, truth));
            }
        }
    }

    /// What a failed comparison prints.
    fn message(&self, what: &str, verdict: &str, estimate: &Estimate, truth: DVec3) -> String {
        let sigmas = (estimate.mean - truth) / estimate.std_error;
        format!(
            "{what}: {verdict}\n  expected  {truth}\n  got       {}\n  std error {} ({} replicates)\n  effect    {} std \
             errors, level {:.1e} each\n  seed      {}\n  replay    FREDHOLM_SEED={} cargo test --release {}",
            estimate.mean,
            estimate.std_error,
            estimate.replicates,
            sigmas,
            self.entry.level(),
            self.seed(),
            self.base_seed,
            self.entry.name
        )
    }
}

/// t* s; 0 for an exact value.
fn half_width(m: Measured, level: f64) -> f64 {
    if m.std_error == 0.0 { 0.0 } else { critical(level, m.dof) * m.std_error }
}
