//! EXR files: what is written is read back bit by bit, files of others are read, broken ones explained.

use super::*;

#[test]
fn exr_round_trip_keeps_names_attributes_and_every_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("terms.exr");
    let beauty = ramp(7, 5, 3.0);
    let mut t00 = ramp(7, 5, 1e-30);
    t00[3] = [f32::NAN, f32::INFINITY, -0.0];
    let attributes = [("fredholm.command", "fredholm series ünï".to_owned()), ("fredholm.seed", "7".into())];
    let written = [("T10", &beauty), ("", &beauty), ("T00", &t00), ("T00_se", &beauty)];
    let written = written.map(|(name, pixels)| layers::Layer { name, pixels });
    layers::write(&path, 7, 5, &written, &attributes).unwrap();

    let image = layers::read(&path).unwrap();
    assert_eq!((image.width, image.height), (7, 5));
    let names: Vec<_> = image.layers.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["", "T00", "T00_se", "T10"]);
    for layer in written {
        let bits = |pixels: &[[f32; 3]]| pixels.iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(image.layer(layer.name).unwrap()), bits(layer.pixels), "layer {}", layer.name);
    }
    let wanted = attributes.map(|(name, value)| (name.to_owned(), value));
    assert_eq!(image.attributes, wanted);
}

#[test]
fn exr_bytes_are_equal_for_equal_input() {
    let folder = tempfile::tempdir().unwrap();
    let pixels = ramp(40, 40, 1.0);
    // Many attributes: kept in a hash map by the crate, whose order differs between two maps of one process.
    let values: Vec<(String, String)> = (0..12).map(|i| (format!("fredholm.a{i}"), i.to_string())).collect();
    let attributes: Vec<(&str, String)> = values.iter().map(|(n, v)| (n.as_str(), v.clone())).collect();
    let bytes = |name: &str| {
        let path = folder.path().join(name);
        layers::write(&path, 40, 40, &[layers::Layer { name: "", pixels: &pixels }], &attributes).unwrap();
        std::fs::read(path).unwrap()
    };
    let first = bytes("a.exr");
    for i in 0..5 {
        assert_eq!(first, bytes(&format!("b{i}.exr")));
    }
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert!(left.iter().all(|n| n.to_string_lossy().ends_with(".exr")), "temporary files left: {left:?}");
}

#[test]
fn exr_of_others_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.exr");
    let part = |name: &str, channels: Vec<(&str, FlatSamples)>| {
        let channels = channels.into_iter().map(|(n, s)| AnyChannel::new(n, s)).collect();
        Part::new((2, 1), LayerAttributes::named(name), Encoding::UNCOMPRESSED, AnyChannels::sort(channels))
    };
    let half = |v: [f32; 2]| FlatSamples::F16(v.map(f16::from_f32).to_vec());

    // Half floats with alpha; grey; a depth channel that is no colour; a layer that lacks a channel.
    let single = part(
        "beauty",
        vec![
            ("R", half([0.5, 2.0])),
            ("G", half([1.0, 3.0])),
            ("B", half([0.25, 4.0])),
            ("half.R", half([0.25, 4.0])),
            ("half.B", half([0.25, 4.0])),
            ("A", half([1.0, 1.0])),
            ("grey.Y", FlatSamples::F32(vec![3.0, 5.0])),
            ("depth.Z", FlatSamples::F32(vec![9.0, 9.0])),
        ],
    );
    Parts::from_layer(single).write().to_file(&path).unwrap();
    let image = layers::read(&path).unwrap();
    assert_eq!(
        image.layers,
        [("".into(), vec![[0.5, 1.0, 0.25], [2.0, 3.0, 4.0]]), ("grey".into(), vec![[3.0; 3], [5.0; 3]])]
    );

    assert_eq!((image.grey, image.incomplete), (vec!["grey".into()], vec![("half".into(), "B R".into())]));

    // One channel of three is no picture, and a part of a picture is not the whole.
    Parts::from_layer(part("x", vec![("R", half([1.0, 1.0]))])).write().to_file(&path).unwrap();
    let message = layers::read(&path).unwrap_err().to_string();
    assert!(message.contains("has only the channel R"), "{message}");
    let rgb = || ["R", "G", "B"].map(|c| (c, half([1.0, 2.0]))).to_vec();
    for (from, display, what) in [
        ((1, 0), ((0, 0), (4, 4)), "a crop: the pixels (1, 0) to (2, 0)"),
        ((-1, 0), ((0, 0), (1, 1)), "a picture with overscan"),
        ((5, 5), ((5, 5), (2, 1)), ""),
    ] {
        let mut one = part("x", rgb());
        one.attributes.layer_position = from.into();
        let mut file = Parts::from_layer(one);
        file.attributes.display_window = IntegerBounds::new(display.0, display.1);
        file.write().to_file(&path).unwrap();
        let said = layers::read(&path).map_err(|e| e.to_string());
        match what {
            "" => assert!(said.is_ok()),
            what => assert!(said.as_ref().is_err_and(|e| e.contains(what) && e.contains("help: ")), "{said:?}"),
        }
    }

    // No colour at all is an error that names what is there.
    Parts::from_layer(part("x", vec![("Z", half([1.0, 1.0]))])).write().to_file(&path).unwrap();
    let message = layers::read(&path).unwrap_err().to_string();
    assert!(message.contains("among: Z") && message.contains("other.exr"), "{message}");
}

#[test]
fn broken_and_missing_files_are_explained() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("noise.exr");
    std::fs::write(&path, b"this is not an image").unwrap();
    for (result, words) in [
        (layers::read(&path).map(|_| ()), "not a readable OpenEXR file"),
        (layers::read(&folder.path().join("absent.exr")).map(|_| ()), "absent.exr"),
        (summary::read(&path).map(|_| ()), "not valid JSON"),
        (summary::write(&folder.path().join("no/such/folder.json"), &Summary::default()), "help: "),
        (layers::write(&path, 2, 2, &[layers::Layer { name: "T00", pixels: &[[0.0; 3]] }], &[]), "1 pixels"),
    ] {
        let message = result.unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    }
}
