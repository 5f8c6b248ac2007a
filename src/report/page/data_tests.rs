use super::*;
use base64::prelude::{BASE64_STANDARD, Engine};
use flate2::read::ZlibDecoder;
use half::f16;
use std::io::Read;

fn image() -> Vec<[f32; 3]> {
    // 30 powers of two, zero, and numbers that are not finite
    let mut pixels: Vec<[f32; 3]> =
        (0..48).map(|i| [1.37f32.powi(i - 40), 0.11 * i as f32, 1.0 / (1.0 + i as f32)]).collect();
    pixels[3] = [0.0, f32::NAN, f32::INFINITY];
    pixels
}

fn unpacked(text: &str) -> Vec<u8> {
    let mut bytes = vec![];
    ZlibDecoder::new(BASE64_STANDARD.decode(text).unwrap().as_slice()).read_to_end(&mut bytes).unwrap();
    bytes
}

#[test]
fn means_keep_eleven_bits_and_errors_their_logarithm() {
    let (pixels, n) = (image(), 48);
    let trust = PixelErrors { layer: "T00".into(), trusted: true, events: 9.0, why: "trusted".into() };
    let mut data = Data::new([8, 6]);
    data.push(&[Image {
        id: "T00".into(),
        world: World::Terms,
        slot: Slot::Term(0),
        spp: 16,
        mean: Some(&pixels),
        std_error: &pixels,
        trust,
        apart: true,
    }]);
    let (layer, bytes) = (&data.layers[0], unpacked(&data.chunks[0].1));
    assert_eq!(bytes.len(), 9 * n);
    let exponent = layer.exponent.unwrap();
    let (lowest, step) = layer.codes;
    let same = |found: f64, v: f32, error: f64| {
        let v = f64::from(v);
        found == v || (found.is_nan() && v.is_nan()) || (found / v - 1.0).abs() <= error
    };
    for (i, pixel) in pixels.iter().enumerate() {
        for (c, v) in pixel.iter().enumerate() {
            let half = f16::from_be_bytes([bytes[c * n + i], bytes[(3 + c) * n + i]]);
            let mean = f64::from(half) * f64::from(exponent).exp2();
            // the exact half of the last digit
            assert!(same(mean, *v, f64::from(-11).exp2()), "{mean} is not {v}");
            let red = bytes[6 * n + i];
            let code = if c == 0 { red } else { bytes[(6 + c) * n + i].wrapping_add(red) };
            let error = match code {
                0 => 0.0,
                254 => f64::INFINITY,
                255 => f64::NAN,
                code => (lowest + step * f64::from(code - 1)).exp2(),
            };
            assert!(same(error, *v, (step / 2.0).exp2() - 1.0 + 1e-9), "{error} is not {v}");
        }
    }
}

#[test]
fn a_black_image_and_a_constant_one_have_codes() {
    for v in [0.0, 0.3] {
        let codes = Logarithms::of(&[[v; 3]; 4], 24.0, 0.125);
        let found = if codes.bytes[0] == 0 { 0.0 } else { codes.lowest.exp2() };
        assert!((found - f64::from(v)).abs() < 1e-7);
        assert_eq!(Means::of(&[[v; 3]; 4]).bytes.len(), 24);
    }
}

#[test]
fn a_large_image_is_reduced_by_means_of_blocks() {
    let data = Data::new([1920, 1080]);
    assert!(data.reduced > 1 && data.width * data.height <= PIXELS);
    let small = Data { reduced: 2, width: 2, height: 1, full: [3, 2], ..Data::default() };
    let pixels = [1.0, 3.0, 5.0, 5.0, 7.0, 9.0].map(|v| [v; 3]);
    assert_eq!(small.mean_of_blocks(&pixels), [[4.0f32; 3], [7.0; 3]]);
    let errors = [0.1f32; 6].map(|v| [v; 3]);
    let found = small.errors_of_blocks(&errors, true);
    assert!((found[0][0] - 0.05).abs() < 1e-7 && (found[1][0] - 0.1 / 2f32.sqrt()).abs() < 1e-7);
    assert!(small.errors_of_blocks(&errors, false)[0][0].is_nan(), "shared noise does not add up");
}

#[test]
fn no_text_of_the_run_ends_its_element() {
    let data = Data { scene: "</script><b>".into(), ..Data::new([1, 1]) };
    let text = data.elements().unwrap();
    assert_eq!(text.matches("</script>").count(), 1);
    assert!(text.contains("\\u003c/script>\\u003cb>"));
}
