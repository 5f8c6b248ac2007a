//! The promises of the report layer: what is written can be read back, equal input gives equal bytes, and nothing on a
//! plot or page is where it should not be.
#![allow(clippy::unwrap_used)]

#[path = "report_files/exr_files.rs"]
mod exr_files;
#[path = "report_files/pages.rs"]
mod pages;
#[path = "report_files/pictures.rs"]
mod pictures;
#[path = "report_files/plots.rs"]
mod plots;
#[path = "report_files/summaries.rs"]
mod summaries;

use std::path::Path;

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image as Parts, IntegerBounds, Layer as Part, LayerAttributes,
    WritableImage, f16,
};
use fredholm::{
    report::{
        figures::{
            decay::{self, Decay, RateKind, RateLine, independent_ratios},
            variance::{self, Falling, Variance},
        },
        image::{
            contact_sheet::{self, Cell},
            exr as layers,
            picture::{NON_FINITE, auto_gain, develop, gain_label, srgb},
            typeset::Caption,
            zmap,
        },
        page::data::{Data, Image, Slot},
        page::html::{self, Plate},
        plot::{Curve, Figure, Look, Point},
        text::{
            grid::Grid,
            pixel_errors::PixelErrors,
            summary::{self, Bounds, Radiosity, Summary, VerdictRecord},
            table,
        },
    },
    stats::Outcome,
    terms::{Cost, Estimate, Functional, Series, World},
};
use glam::DVec3;
use proptest::prelude::*;

fn caption() -> Caption {
    Caption { command: "fredholm series cornell --spp 16 --seed 3".into(), seed: 3, scene: "cornell".into() }
}

/// A small image with something different in every pixel and channel.
fn ramp(width: usize, height: usize, scale: f32) -> Vec<[f32; 3]> {
    (0..width * height).map(|i| [0, 1, 2].map(|c| scale * (3 * i + c) as f32 / (3 * width * height) as f32)).collect()
}

fn estimate(v: f64, replicates: u64) -> Estimate {
    let std_error = if replicates == 1 { DVec3::NAN } else { DVec3::splat(0.01 * v) };
    Estimate { mean: DVec3::new(v, v / 3.0, v / 7.0), std_error, replicates, events: None }
}

fn full_summary() -> Summary {
    let terms: Vec<_> = (0..3).map(|k| estimate(0.5f64.powi(k), 16)).collect();
    let functional = Functional {
        name: "image".into(),
        terms: terms.clone(),
        tail: estimate(0.1, 1),
        sum: estimate(1.7, 16),
        total: estimate(1.8, 16),
    };
    let cost = Cost { paths: 10, rays: u64::MAX, non_finite: 0, seconds: 0.1 + 0.2 };
    let series = Series {
        world: World::Terms,
        label: "prefix, mis".into(),
        functionals: vec![functional],
        cost,
        unsampled: vec![],
        doubts: vec![],
        undecided: None,
        variance: Default::default(),
    };
    let verdict = VerdictRecord {
        name: "T1: terms − radiosity".into(),
        effect: 1e-300,
        interval: (f64::NEG_INFINITY, 0.1),
        p: f64::NAN,
        min_detectable: 0.3,
        outcome: Outcome::Inconclusive,
    };
    Summary {
        command: "fredholm series \"a b\"".into(),
        seed: u64::MAX,
        seconds: std::f64::consts::PI,
        terms: summary::terms(&terms, &[DVec3::ONE], &[7, 8]),
        tail: estimate(0.1, 1),
        radiosity: Some(Radiosity {
            patches: 600,
            terms: vec![DVec3::X],
            sum: DVec3::Y,
            full: DVec3::Z,
            spectral_radius: DVec3::splat(0.58),
            spectral_radius_limit: DVec3::splat(0.59),
            spectral_radius_limit_error: DVec3::NAN,
            unlit_sides: 0,
            norms: vec![],
            discretisation: DVec3::NAN,
        }),
        bounds: Bounds { max_albedo: DVec3::splat(0.76), ..Bounds::default() },
        verdicts: vec![verdict],
        files: vec!["terms.exr".into()],
        series: vec![series],
        ..Summary::default()
    }
}

fn curve(points: Vec<Point>) -> Curve {
    Curve { label: "curve".into(), points, look: Look::SINGLE }
}
