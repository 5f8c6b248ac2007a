//! Pictures: sRGB codes to the bit, sheets with every pixel, maps of z.

use super::*;

/// Every 8-bit code comes back from the linear value in the middle of its interval, found with the inverse curve of
/// the standard rather than with ours.
#[test]
fn srgb_codes_are_exact() {
    let inverse = |v: f64| if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
    for code in 0..=255u8 {
        let linear = inverse(f64::from(code) / 255.0);
        assert!((srgb(linear) - f64::from(code) / 255.0).abs() < 1e-6);
        let developed = develop(1, 1, &[[(linear / 4.0) as f32; 3]], 4.0);
        assert_eq!(developed.picture.pixels, [[code; 3]]);
    }
}

#[test]
fn png_holds_the_codes_and_counts_what_it_cannot_show() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.png");
    let developed = develop(5, 1, &[[0.5; 3], [2.0, 0.0, 0.0], [-0.1, 0.0, 0.0], [f32::NAN; 3], [0.0, 0.0, 1.0]], 1.0);
    assert_eq!((developed.clipped, developed.negative, developed.non_finite), (1, 1, 1));
    developed.picture.write(&path).unwrap();
    let read = image::open(&path).unwrap().to_rgb8();
    let pixels: Vec<[u8; 3]> = read.pixels().map(|p| p.0).collect();
    assert_eq!(pixels, [[188; 3], [255, 0, 0], [0, 0, 0], NON_FINITE, [0, 0, 255]]);
    assert_eq!(std::fs::read(&path).unwrap(), developed.picture.png(&path).unwrap());
}

proptest! {
    /// The gain is one of the nice numbers and brings a constant image within half a step of 0.8.
    #[test]
    fn auto_exposure_is_nice_and_near(log_level in -30.0f32..10.0) {
        let level = log_level.exp();
        let gain = auto_gain(&[[level; 3]; 10]);
        let up = gain.max(1.0 / gain);
        let mantissa = up / up.log2().floor().exp2();
        prop_assert!((mantissa - 1.0).abs() < 1e-9 || (mantissa - 1.5).abs() < 1e-9, "{gain}");
        let shown = gain * f64::from(level) / 0.8;
        prop_assert!((1.5f64.sqrt().recip() - 1e-6..=1.5f64.sqrt() + 1e-6).contains(&shown), "{gain} shows {shown}");
        prop_assert!(gain_label(gain).starts_with(['×', '÷']));
    }
}

#[test]
fn sheets_show_every_pixel_of_every_image() {
    let (w, h) = (260, 40);
    let images: Vec<_> = (0..7).map(|i| ramp(w, h, 1.0 + i as f32)).collect();
    let cells: Vec<_> =
        images.iter().enumerate().map(|(i, pixels)| Cell { label: format!("T{i}"), pixels, gain: Some(0.1) }).collect();
    let sheet = contact_sheet::grid("seven", w, h, &cells, &caption()).unwrap();
    assert_eq!(sheet.clipped, [0; 7]);
    // Two rows of four: more than three images wide, less than five.
    assert!((4 * w..5 * w).contains(&sheet.picture.width), "{}", sheet.picture.width);
    assert!((2 * h..12 * h).contains(&sheet.picture.height), "{}", sheet.picture.height);
    for pixels in &images {
        let wanted = develop(w, h, pixels, 0.1).picture;
        let page = &sheet.picture;
        let found = (0..page.height - h).any(|y| {
            (0..page.width - w)
                .any(|x| (0..h).all(|r| page.pixels[(y + r) * page.width + x..][..w] == wanted.pixels[r * w..][..w]))
        });
        assert!(found, "an image is covered or missing");
    }

    // A small image is enlarged by a whole factor, and the strip lies below it.
    let (single, gain) = contact_sheet::single("T3", 16, 16, &ramp(16, 16, 0.05), None).unwrap();
    assert_eq!((single.picture.width, gain), (48, 16.0));
    assert!(single.picture.height > 48);
    let codes = develop(16, 16, &ramp(16, 16, 0.05), gain).picture;
    for (i, pixel) in single.picture.pixels[..48 * 48].iter().enumerate() {
        assert_eq!(*pixel, codes.pixels[i / 48 / 3 * 16 + i % 48 / 3]);
    }
    assert!(contact_sheet::grid("none", w, h, &[], &caption()).is_err());
    assert!(contact_sheet::single("T0", 3, 3, &ramp(2, 2, 1.0), None).is_err());
}

#[test]
fn z_map_counts_and_colours() {
    let mut z = vec![0.0; 400];
    z[..4].copy_from_slice(&[f64::NAN, 2.5, -3.5, f64::INFINITY]);
    let map = zmap::draw("T1", 20, 20, &z, &caption()).unwrap();
    assert_eq!(map.defined, 399);
    assert!((map.beyond_2 - 3.0 / 399.0).abs() < 1e-12 && (map.beyond_3 - 2.0 / 399.0).abs() < 1e-12);
    let [r, _, b] = zmap::color(-3.0);
    let [r2, _, b2] = zmap::color(3.0);
    assert!(b > r && r2 > b2, "negative is blue, positive is red");
}
