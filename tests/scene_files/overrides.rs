//! Keys changed from outside, and materials that are made to emit.

use super::*;

#[test]
fn overrides_replace_values() {
    let d = with(&[
        "materials.white.reflectance=[0.25, 0.5, 0.75]",
        "materials.white.sides=front",
        "shapes[1].emission=[4, 5, 6]",
        "shapes.2.inward = false",
        "camera.size[0]=16",
        "camera.fov=50",
        "camera.fov=60",
        "name=\"other\"",
    ])
    .unwrap()
    .description;
    assert_eq!(
        (d.materials[0].lambertian().unwrap(), d.materials[0].sides),
        (DVec3::new(0.25, 0.5, 0.75), Sides::Front)
    );
    assert_eq!(d.shapes[1].emission, DVec3::new(4.0, 5.0, 6.0));
    assert!(matches!(d.shapes[2].geometry, Geometry::Sphere { inward: false, .. }));
    assert_eq!((d.camera.size, d.camera.fov, d.name.as_str()), ([16, 6], 60.0, "other"));
    // an override can light a dark scene, and a wrong file can be put right
    let dark = GOOD.replace("emission = [1, 2, 3]\n", "").replace("fov = 40", "fov = 400");
    assert!(toml(&dark, Path::new("x.toml"), &options(&["shapes[0].power=[1, 1, 1]", "camera.fov=40"], &[])).is_ok());
}

#[test]
fn wrong_overrides_name_themselves() {
    for (set, key, what, help) in [
        (
            "materials.whit.reflectance=[1,1,1]",
            "materials.whit.reflectance",
            "`materials` has no `whit`",
            "did you mean `white`?",
        ),
        ("camera.fvo=3", "camera.fvo", "unknown key `fvo`", "did you mean `fov`?"),
        ("camra.fov=3", "camra.fov", "the scene has no `camra`", "did you mean `camera`?"),
        ("camera.fov=300", "camera.fov", "fov 300 is outside (0, 180)", "degrees"),
        ("camera.fov=[1", "camera.fov", "`[1` is not a TOML value", "number"),
        ("camera.fov", "camera.fov", "an override needs a value", "KEY=VALUE"),
        ("camera.fov=", "camera.fov", "`` is not a TOML value", "number"),
        ("camera.fov.x=3", "camera.fov.x", "`camera.fov` is an integer and has no `x`", "remove"),
        (
            "shapes[5].emission=[1,1,1]",
            "shapes[5].emission",
            "`shapes` has no element [5], only 5 elements",
            "start at 0",
        ),
        ("shapes[x].emission=[1,1,1]", "shapes[x].emission", "`shapes[x].emission` is not a key", "shapes[5].emission"),
        ("shapes[0].emission=[1,-1,1]", "shapes[0].emission", "emission -1 is negative", "at least 0"),
        (
            "materials.white.reflectance[1]=2",
            "materials.white.reflectance",
            "reflectance 2 is outside [0, 1]",
            "receives",
        ),
        ("materials.new={type=\"diffuse\"}", "materials.new.reflectance", "missing key `reflectance`", "add"),
        ("light=3", "light", "unknown key `light`", "keys here"),
    ] {
        let e = with(&[set]).expect_err(set);
        assert!(e.what.starts_with(what), "{set}: {e}");
        assert_eq!((e.key, e.line, e.file), (Some(format!("--set {key}")), None, None), "{set}");
        assert!(e.help.as_deref().unwrap_or_default().contains(help), "{set}: {:?}", e.help);
    }
}

#[test]
fn emit_lights_every_shape_of_a_material() {
    let good = Path::new("good.toml");
    let d = toml(GOOD, good, &options(&[], &["left=7, 8, 9"])).unwrap().description;
    let lit: Vec<_> = d.shapes.iter().map(|s| s.emission.x).collect();
    assert_eq!(lit, [1.0, 7.0, 7.0, 0.0, 0.0]);
    for (emit, what) in [
        ("lfet=1,1,1", "no shape uses a material `lfet`"),
        ("left", "no radiance is given"),
        ("left=1,1", "`1,1` is not a radiance of three channels"),
        ("left=1,1,x", "`1,1,x` is not a radiance of three channels"),
        ("left=1,1,-1", "`1,1,-1` is not a radiance of three channels"),
        ("left=1,1,NaN", "`1,1,NaN` is not a radiance of three channels"),
    ] {
        let e = toml(GOOD, good, &options(&[], &[emit])).expect_err(emit);
        assert_eq!((e.what.as_str(), e.key), (what, Some(format!("--emit {emit}"))));
    }
}
