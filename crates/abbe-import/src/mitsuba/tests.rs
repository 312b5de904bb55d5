//! Tests of the reader of Mitsuba scenes: what each plugin becomes, and which errors it states.

use super::*;
use abbe_format::{read, resolve::resolve};
use serde_json::{Value, json};
use tempfile::TempDir;

const SENSOR: &str = r#"<sensor type="perspective"><float name="fov" value="40"/><film type="hdrfilm">
    <integer name="width" value="96"/><integer name="height" value="64"/></film></sensor>"#;

const QUAD: &str = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nf 1 2 3\n";

/// A scene in its own folder.
pub(super) struct Imported {
    folder: TempDir,
    result: Result<ImportedScene>,
}

impl Imported {
    /// Converts a scene that consists of `body`.
    pub(super) fn whole(text: &str, files: &[(&str, &[u8])]) -> Self {
        let folder = TempDir::new().unwrap();
        for (name, bytes) in files {
            std::fs::write(folder.path().join(name), bytes).unwrap();
        }
        let path = folder.path().join("a.xml");
        std::fs::write(&path, text).unwrap();
        let result = super::super::import(&path, "", FileAccess::WithinFolder);
        Self { folder, result }
    }

    /// Converts a scene with a sensor and `body`.
    fn of(body: &str) -> Self {
        Self::with_files(body, &[])
    }

    pub(super) fn with_files(body: &str, files: &[(&str, &[u8])]) -> Self {
        Self::whole(&format!("<scene version=\"3.0.0\">\n{SENSOR}\n{body}\n</scene>"), files)
    }

    /// Returns the scene file. Checks that Abbe can read it.
    pub(super) fn scene(&self) -> Value {
        let imported = self.result.as_ref().unwrap_or_else(|error| panic!("{error}"));
        let path = self.folder.path().join("a.json");
        std::fs::write(&path, &imported.text).unwrap();
        let (file, source) = read(&path, &[]).unwrap_or_else(|error| panic!("{error}\n{}", imported.text));
        resolve(&file, &source).unwrap_or_else(|error| panic!("{error}\n{}", imported.text));
        serde_json::from_str(&imported.text).unwrap()
    }

    pub(super) fn left_out(&self) -> String {
        self.result.as_ref().unwrap().left_out.join("\n")
    }

    fn error(&self) -> String {
        self.result.as_ref().unwrap_err().to_string()
    }
}

/// Returns the material of a ball with the BSDF, and the remarks.
fn material(bsdf: &str) -> (Value, String) {
    let imported = Imported::of(&format!("<shape type=\"sphere\">{bsdf}</shape>"));
    let scene = imported.scene();
    let name = scene["objects"][0]["material"].as_str().unwrap();
    (scene["materials"][name].clone(), imported.left_out())
}

/// Returns the only light.
fn light(emitter: &str) -> (Value, String) {
    let imported = Imported::of(&format!("<shape type=\"sphere\"/>{emitter}"));
    (imported.scene()["lights"][0].clone(), imported.left_out())
}

fn object(shape: &str) -> (Value, String) {
    let imported = Imported::with_files(shape, &[("q.obj", QUAD.as_bytes())]);
    (imported.scene()["objects"][0].clone(), imported.left_out())
}

pub(super) fn close(found: &Value, expected: f64) {
    let found = found.as_f64().unwrap_or_else(|| panic!("{found} is no number"));
    assert!((found - expected).abs() < 1e-6 * expected.abs().max(1.0), "{found} instead of {expected}");
}

fn close_triple(found: &Value, expected: [f64; 3]) {
    (0..3).for_each(|i| close(&found[i], expected[i]));
}

/// Returns the cells of a row of a table, which `|` separates.
fn cells<const N: usize>(row: &str) -> [&str; N] {
    row.split('|').map(str::trim).collect::<Vec<_>>().try_into().unwrap()
}

/// Returns a BSDF whose contents are XML, or properties such as `float alpha 0.25; rgb k 3`.
fn bsdf(kind: &str, contents: &str) -> String {
    let property = |text: &str| {
        let mut words = text.trim().splitn(3, ' ');
        let [tag, name, value] = [(); 3].map(|()| words.next().unwrap());
        format!("<{tag} name=\"{name}\" value=\"{value}\"/>")
    };
    let is_xml = contents.is_empty() || contents.starts_with('<');
    let contents = if is_xml { contents.to_string() } else { contents.split(';').map(property).collect() };
    format!("<bsdf type=\"{kind}\">{contents}</bsdf>")
}

#[test]
fn simple_materials_keep_their_numbers() {
    for row in r#"
        diffuse | | {"diffuse": {"reflectance": 0.5}}
        diffuse | rgb reflectance 0.1, 0.2 0.3 | {"diffuse": {"reflectance": {"rgb": [0.1, 0.2, 0.3]}}}
        twosided | <bsdf type="diffuse"><rgb name="reflectance" value="0.7"/></bsdf> | {"diffuse": {"reflectance": 0.7}}
        diffuse | spectrum reflectance 300:0.1, 900:0.4 |
            {"diffuse": {"reflectance": {"table": {"nm": [300.0, 900.0], "values": [0.1, 0.4]}}}}
        dielectric | | {"dielectric": {"ior": 1.5046}}
        dielectric | string int_ior Water | {"dielectric": {"ior": 1.333}}
        roughdielectric | string distribution ggx; float alpha 0.25; float int_ior 1.6 |
            {"dielectric": {"ior": 1.6, "roughness": 0.5}}
        thindielectric | float int_ior 1.6 | {"thin_dielectric": {"ior": 1.6}}
        conductor | string material Au | {"conductor": {"metal": "gold"}}
        conductor | | {"mirror": {"reflectance": 1.0}}
        roughconductor | string distribution ggx; float alpha 0.04; float eta 1.5; rgb k 3 |
            {"conductor": {"eta": 1.5, "k": 3.0, "roughness": 0.2}}
        plastic | rgb diffuse_reflectance 0.3 | {"glossy": {"reflectance": 0.3, "ior": 1.49, "roughness": 0.0}}
        difftrans | float transmittance 0.4 | {"translucent": {"reflectance": 0.0, "transmittance": 0.4}}"#
        .replace("|\n", "| ")
        .lines()
        .skip(1)
    {
        let [kind, contents, expected] = cells(row);
        let (found, notes) = material(&bsdf(kind, contents));
        assert_eq!(found, serde_json::from_str::<Value>(expected).unwrap(), "{row}");
        assert_eq!(notes, "", "{row}");
    }
}

#[test]
fn a_mask_cuts_holes() {
    let (found, notes) = material(&bsdf("mask", r#"<bsdf type="diffuse"/><float name="opacity" value="0.75"/>"#));
    assert_eq!((&found["mix"][0]["weight"], &found["mix"][1]["weight"]), (&json!(0.75), &json!(0.25)));
    assert_eq!((&found["mix"][1]["material"], notes.as_str()), (&json!("hole"), ""));
}

#[test]
fn approximated_materials_are_noted() {
    for row in r#"
        roughconductor | float alpha 0.09 | conductor | replaced by GGX
        conductor | string material Hg | conductor | becomes chromium
        hair | | diffuse | "hair" is not supported
        bumpmap | <bsdf type="plastic"/> | glossy | "bumpmap" is left out
        mask | <bsdf type="dielectric"/><float name="opacity" value="0.6"/> | dielectric | mask
        principled | float spec_trans 1 | dielectric | principled
        principled | float sheen 1 | glossy | `sheen`
        diffuse | rgb reflectance 1.5 | diffuse | above 1
        diffuse | float gloss 1 | diffuse | a.xml:4: `gloss` of <bsdf
        dielectric | float ext_ior 1.33 | dielectric | `ext_ior` is left out
        dielectric | float specular_transmittance 0.5 | dielectric | the factor "specular_transmittance""#
        .lines()
        .skip(1)
    {
        let [kind, contents, becomes, note] = cells(row);
        let (found, notes) = material(&bsdf(kind, contents));
        assert!(found.get(becomes).is_some() && notes.contains(note), "{row}: {found}, {notes}");
    }
}

/// Abbe states the fraction of the light in the coat that leaves it. With `nonlinear`,
/// Mitsuba states the reflectance of the base below the coat.
#[test]
fn a_nonlinear_plastic_is_darker() {
    let (found, _) = material(
        r#"<bsdf type="plastic"><float name="diffuse_reflectance" value="0.6"/><boolean name="nonlinear" value="true"/></bsdf>"#,
    );
    let reflectance = found["glossy"]["reflectance"].as_f64().unwrap();
    // The internal diffuse reflectance of the index 1.49 is 0.59.
    assert!((reflectance - 0.6 * 0.41 / (1.0 - 0.6 * 0.59)).abs() < 0.01, "{reflectance}");
}

#[test]
fn a_blend_is_a_mix_of_two_materials() {
    let imported = Imported::of(
        r#"<bsdf type="diffuse" id="a"/><shape type="sphere"><bsdf type="blendbsdf" id="both">
           <float name="weight" value="0.25"/><ref id="a"/><bsdf type="conductor" id="b"/></bsdf></shape>"#,
    );
    let scene = imported.scene();
    let parts = json!([{"material": "a", "weight": 0.75}, {"material": "b", "weight": 0.25}]);
    assert_eq!(scene["materials"]["both"]["mix"], parts);
    assert_eq!(scene["objects"][0]["material"], "both");
}

#[test]
fn lights_have_photometric_quantities() {
    let (found, _) = light(r#"<emitter type="constant"><rgb name="radiance" value="1, 2, 0.5"/></emitter>"#);
    assert_eq!(found["environment"]["spectrum"], json!({"rgb": [1.0, 2.0, 0.5]}));
    close(&found["environment"]["luminance"], 0.2126 + 1.4304 + 0.0361);
    let (found, _) = light(r#"<emitter type="constant"><spectrum name="radiance" value="2"/></emitter>"#);
    assert_eq!(found["environment"], json!({"spectrum": 1, "luminance": 2.0}));
    let (found, _) = light(r#"<emitter type="constant"><spectrum name="radiance" value="360:3, 830:3"/></emitter>"#);
    close(&found["environment"]["luminance"], 3.0);
    let (found, _) = light(
        r#"<emitter type="point"><float name="intensity" value="5"/><transform name="to_world"><translate x="1" y="2"/>
           </transform></emitter>"#,
    );
    assert_eq!(found, json!({"point": {"at": [1.0, 2.0, 0.0], "spectrum": "D65", "luminous_intensity": 5.0}}));
    let (found, notes) = light(
        r#"<emitter type="spot"><rgb name="intensity" value="4"/><float name="cutoff_angle" value="30"/>
           <transform name="to_world"><lookat origin="0, 3, 0" target="0, 0, 0" up="0, 0, 1"/></transform></emitter>"#,
    );
    let spot = &found["spot"];
    assert_eq!((&spot["half_angle"], &spot["penumbra"]), (&json!(30.0), &json!(7.5)));
    close_triple(&spot["to"], [0.0, 2.0, 0.0]);
    assert!(spot["falloff"] == "linear" && notes.is_empty(), "{notes}");
    let (found, _) = light(
        r#"<emitter type="directional"><vector name="direction" x="0" y="-2" z="0"/><rgb name="irradiance" value="3"/>
           </emitter>"#,
    );
    close_triple(&found["directional"]["toward"], [0.0, -1.0, 0.0]);
    close(&found["directional"]["illuminance"], 3.0);
}

#[test]
fn unknown_and_missing_emitters_are_noted() {
    let imported = Imported::of(r#"<shape type="sphere"/><emitter type="sunsky"/>"#);
    assert!(imported.left_out().contains("\"sunsky\" is not supported"));
    assert!(imported.result.as_ref().unwrap().added[0].contains("a uniform sky"));
    imported.scene();
}

#[test]
fn shapes_are_placed_and_face_like_in_mitsuba() {
    let (found, notes) = object(
        r#"<shape type="rectangle" id="lamp"><transform name="to_world"><scale value="2"/><translate y="1"/></transform>
           <emitter type="area"><rgb name="radiance" value="3"/></emitter></shape>"#,
    );
    assert_eq!(found["name"], "lamp");
    assert_eq!(found["shape"], json!({"rectangle": {"width": 2, "height": 2}}));
    assert_eq!(found["transform"][0], json!({"rotate": {"axis": [1, 0, 0], "degrees": 90}}));
    assert_eq!(found["transform"][1]["matrix"][1], json!([0.0, 2.0, 0.0, 1.0]));
    assert_eq!(found["emission"], json!({"spectrum": "D65", "luminance": 3.0}));
    assert_eq!(notes, "");
    let (found, notes) = object(r#"<shape type="disk"><boolean name="flip_normals" value="true"/></shape>"#);
    assert_eq!(found["transform"][0]["rotate"]["degrees"], -90);
    assert!(notes.contains("black from behind"), "{notes}");
    let (found, _) = object(
        r#"<shape type="sphere"><point name="center" value="1, 2, 3"/><float name="radius" value="0.5"/></shape>"#,
    );
    assert_eq!(found["shape"], json!({"sphere": {"center": [1.0, 2.0, 3.0], "radius": 0.5}}));
    let (found, _) = object(r#"<shape type="cube"/>"#);
    assert_eq!(found["shape"], json!({"box": {"size": [2, 2, 2]}}));
    let (found, _) = object(r#"<shape type="cylinder"><point name="p1" value="0, 3, 0"/></shape>"#);
    assert_eq!(found["shape"]["triangles"]["indices"].as_array().unwrap().len(), 192);
    let (found, notes) = object(r#"<shape type="sphere"/><shape type="bsplinecurve"/>"#);
    assert!(found["shape"]["sphere"].is_object() && notes.contains("\"bsplinecurve\" is not supported"), "{notes}");
}

#[test]
fn meshes_keep_their_side_and_their_texture_coordinates() {
    let mesh = |extra: &str| {
        let shape = format!(r#"<shape type="obj"><string name="filename" value="q.obj"/>{extra}</shape>"#);
        object(&shape).0["shape"]["mesh"].clone()
    };
    assert_eq!(mesh(""), json!({"path": "q.obj", "smooth": true}));
    let switches = r#"<boolean name="face_normals" value="true"/><boolean name="flip_normals" value="true"/>
        <boolean name="flip_tex_coords" value="false"/>"#;
    assert_eq!(mesh(switches), json!({"path": "q.obj", "flat": true, "reverse": true, "flip_v": true}));
    let one_sided = |bsdf: &str| {
        let shape = r#"<shape type="obj"><string name="filename" value="q.obj"/>"#;
        object(&format!("{shape}{bsdf}</shape>")).1.contains("black from behind")
    };
    assert!(one_sided("") && !one_sided(r#"<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>"#));
    // Without vertex normals, a mirrored mesh faces the other way.
    let mirrored = r#"<transform name="to_world"><scale x="-1"/></transform>"#;
    assert_eq!(mesh(mirrored), json!({"path": "q.obj", "smooth": true, "reverse": true}));
}

#[test]
fn instances_copy_the_shapes_of_their_group() {
    let imported = Imported::of(
        r#"<shape type="shapegroup" id="g"><shape type="sphere"><transform name="to_world"><translate x="1"/></transform>
           </shape><shape type="cube"/></shape>
           <shape type="instance"><ref id="g"/><transform name="to_world"><translate y="2"/></transform></shape>
           <shape type="instance"><ref id="g"/></shape>"#,
    );
    let scene = imported.scene();
    let objects = scene["objects"].as_array().unwrap();
    assert_eq!(objects.len(), 4);
    assert_eq!(objects[0]["transform"], json!([{"translate": [1.0, 2.0, 0.0]}]));
    assert_eq!(objects[2]["transform"], json!([{"translate": [1.0, 0.0, 0.0]}]));
}

#[test]
fn the_sensor_is_not_mirrored() {
    let sensor = |extra: &str| {
        let text = format!(
            r#"<scene version="3.0.0"><sensor type="perspective"><transform name="to_world">
               <lookat origin="1, 2, 3" target="1, 2, 0" up="0, 1, 0"/></transform>{extra}<film type="hdrfilm">
               <integer name="width" value="200"/><integer name="height" value="100"/></film></sensor>
               <shape type="sphere"/></scene>"#
        );
        Imported::whole(&text, &[]).scene()["camera"].clone()
    };
    let camera = sensor(r#"<float name="fov" value="90"/>"#);
    close_triple(&camera["from"], [1.0, 2.0, 3.0]);
    close_triple(&camera["at"], [1.0, 2.0, 2.0]);
    close_triple(&camera["up"], [0.0, 1.0, 0.0]);
    close(&camera["lens"]["pinhole"]["fov"], 2.0 * 0.5_f64.atan().to_degrees());
    for (axis, tangent) in [("y", 1.0), ("smaller", 1.0), ("larger", 0.5), ("diagonal", 1.0 / 5.0_f64.sqrt())] {
        let camera = sensor(&format!(r#"<float name="fov" value="90"/><string name="fov_axis" value="{axis}"/>"#));
        close(&camera["lens"]["pinhole"]["fov"], 2.0 * f64::atan(tangent).to_degrees());
    }
    let half_diagonal = 0.5 * 36.0_f64.hypot(24.0) / 50.0;
    close(&sensor("")["lens"]["pinhole"]["fov"], 2.0 * (half_diagonal / 5.0_f64.sqrt()).atan().to_degrees());
}

#[test]
fn a_thin_lens_keeps_its_radius() {
    let text = r#"<scene version="3.0.0"><sensor type="thinlens"><float name="aperture_radius" value="0.5"/>
        <float name="focus_distance" value="2"/><float name="fov" value="40"/></sensor><shape type="sphere"/></scene>"#;
    let scene = Imported::whole(text, &[]).scene();
    let lens = &scene["camera"]["lens"]["thin"];
    close(&lens["defocus_angle"], 2.0 * 0.25_f64.atan().to_degrees());
    assert_eq!(scene["film"], json!({"width": 768, "height": 576}));
}

#[test]
fn media_fill_bodies_and_the_space_around_the_sensor() {
    let text = r#"<scene version="3.0.0">
        <medium type="homogeneous" id="fog"><float name="sigma_t" value="2"/><float name="albedo" value="0.25"/>
          <float name="scale" value="0.5"/><phase type="hg"><float name="g" value="0.3"/></phase></medium>
        <sensor type="perspective"><ref id="fog"/></sensor>
        <shape type="sphere"><bsdf type="null"/><ref name="interior" id="fog"/><ref name="exterior" id="fog"/></shape>
        <shape type="cube"><bsdf type="dielectric" id="glass"/><medium name="interior" type="homogeneous" id="milk">
          <rgb name="albedo" value="0.9, 0.5, 0.1"/></medium></shape></scene>"#;
    let imported = Imported::whole(text, &[]);
    let scene = imported.scene();
    assert_eq!(scene["atmosphere"], "fog");
    let fog = json!({"absorption": 0.75, "scattering": 0.25, "phase": {"henyey_greenstein": {"g": 0.3}}});
    assert_eq!(scene["media"]["fog"]["homogeneous"], fog);
    assert_eq!(scene["materials"]["null"], json!({"boundary": {"medium": "fog"}}));
    assert_eq!(scene["materials"]["glass"]["dielectric"]["medium"], "milk");
    let milk = &scene["media"]["milk"]["homogeneous"];
    let [scattering, absorption] = ["scattering", "absorption"].map(|key| milk[key]["table"]["values"][20].as_f64());
    assert!((scattering.unwrap() + absorption.unwrap() - 1.0).abs() < 1e-9);
    assert_eq!(imported.left_out(), "");
}

/// A heterogeneous medium ends at its extinction's box: the transformed unit cube of a constant.
#[test]
fn a_constant_extinction_fills_a_box() {
    let imported = Imported::of(
        r#"<medium type="heterogeneous" id="m"><float name="scale" value="4"/><float name="albedo" value="0.25"/>
        <volume name="sigma_t" type="constvolume"><float name="value" value="0.5"/><transform name="to_world">
        <translate x="-0.5"/></transform></volume></medium>
        <shape type="sphere"><bsdf type="null"/><ref name="interior" id="m"/></shape>"#,
    );
    let medium = &imported.scene()["media"]["m"]["grid"];
    assert_eq!((&medium["bounds"], &medium["density"]), (&json!([[0, 0, 0], [1, 1, 1]]), &json!({"constant": 1})));
    close(&medium["absorption"], 1.5);
    close(&medium["scattering"], 0.5);
    assert_eq!(medium["transform"], json!([{"translate": [-0.5, 0.0, 0.0]}]));
}

/// Light enters a thin pane, so the medium behind it is seen.
#[test]
fn a_thin_pane_around_a_medium_is_its_boundary() {
    let imported = Imported::of(
        r#"<medium type="homogeneous" id="m"/>
        <shape type="sphere"><bsdf type="thindielectric"/><ref name="interior" id="m"/></shape>"#,
    );
    let scene = imported.scene();
    let name = scene["objects"][0]["material"].as_str().unwrap();
    assert_eq!(scene["materials"][name], json!({"boundary": {"medium": "m"}}));
    assert!(imported.left_out().contains("a thin pane around a medium reflects nothing"));
}

#[test]
fn a_grid_of_densities_becomes_a_grid_medium() {
    let mut vol = b"VOL\x03".to_vec();
    [1_i32, 2, 1, 1, 1].iter().for_each(|n| vol.extend(n.to_le_bytes()));
    [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0, 0.5, 2.0].iter().for_each(|x| vol.extend(x.to_le_bytes()));
    let body = r#"<shape type="cube"><bsdf type="null"/><medium name="interior" type="heterogeneous" id="m">
        <volume name="sigma_t" type="gridvolume"><string name="filename" value="a.vol"/><transform name="to_world">
        <translate x="3"/></transform></volume><float name="albedo" value="0.75"/><float name="scale" value="4"/>
        </medium></shape>"#;
    let imported = Imported::with_files(body, &[("a.vol", &vol)]);
    let expected = json!({
        "absorption": 1.0, "scattering": 3.0, "phase": "isotropic", "bounds": [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]],
        "density": {"values": [0.5, 2.0], "resolution": [2, 1, 1]}, "transform": [{"translate": [3.0, 0.0, 0.0]}]
    });
    assert_eq!(imported.scene()["media"]["m"]["grid"], expected);
    assert!(Imported::with_files(body, &[("a.vol", b"VOL")]).error().contains("a.xml:5"));
}

#[test]
fn parameters_and_included_files_are_inserted() {
    let text = r#"<scene version="3.0.0"><default name="r" value="2"/><default name="radius" value="5"/>
        <default name="r" value="3"/><include filename="part.xml"/></scene>"#;
    let part = format!(
        r#"<scene version="3.0.0">{SENSOR}<shape type="sphere"><float name="radius" value="$radius"/>
           <point name="center" x="$r" y="0" z="0"/></shape></scene>"#
    );
    let scene = Imported::whole(text, &[("part.xml", part.as_bytes())]).scene();
    assert_eq!(scene["objects"][0]["shape"], json!({"sphere": {"center": [2.0, 0.0, 0.0], "radius": 5.0}}));
}

#[test]
fn names_of_old_files_are_understood() {
    let text = r#"<scene version="0.6.0"><sensor type="perspective"><string name="fovAxis" value="y"/>
        <float name="fov" value="30"/></sensor><shape type="sphere"><transform name="toWorld"><translate x="1"/>
        </transform><bsdf type="dielectric"><float name="intIOR" value="1.4"/></bsdf></shape></scene>"#;
    let scene = Imported::whole(text, &[]).scene();
    assert_eq!(scene["materials"]["dielectric"]["dielectric"]["ior"], 1.4);
    assert_eq!(scene["objects"][0]["transform"], json!([{"translate": [1.0, 0.0, 0.0]}]));
    close(&scene["camera"]["lens"]["pinhole"]["fov"], 30.0);
}

#[test]
fn settings_that_change_the_picture_are_noted() {
    let imported = Imported::of(
        r#"<shape type="sphere"/><integrator type="path"><integer name="max_depth" value="3"/></integrator>"#,
    );
    assert!(imported.left_out().contains("a.xml:4: `max_depth` is left out"), "{}", imported.left_out());
}

/// Every error names the file and the line.
#[test]
fn errors_name_the_file_and_the_line() {
    let ball = |inner: &str| format!("<shape type=\"sphere\">{inner}</shape>");
    let one = r#"<bsdf type="diffuse" id="a"/>"#;
    let twosided = |id: &str, of: &str| format!(r#"<bsdf type="twosided" id="{id}"><ref id="{of}"/></bsdf>"#);
    for (body, line, what) in [
        (ball(r#"<float name="radius" value="two"/>"#), 4, "found \"two\""),
        (ball(r#"<float name="radius" value="1e999"/>"#), 4, "expected a number"),
        (ball(r#"<float name="radius" value="-1"/>"#), 4, "found the radius -1"),
        (ball(r#"<ref id="missing"/>"#), 4, "unknown identifier \"missing\""),
        (ball(r#"<float name="radius" value="$r"/>"#), 4, "unknown parameter \"r\""),
        (ball(r#"<transform name="to_world"><turn/></transform>"#), 4, "found <turn> inside <transform>"),
        (ball(r#"<transform name="to_world"><scale value="0"/></transform>"#), 4, "singular"),
        (ball(r#"<transform name="to_world"><matrix value="1 2 3"/></transform>"#), 4, "a matrix of 3 numbers"),
        (ball(r#"<bsdf type="dielectric"><string name="int_ior" value="glas"/></bsdf>"#), 4, "unknown index"),
        (ball(r#"<bsdf type="twosided"/>"#), 4, "without a BSDF"),
        (ball(r#"<bsdf type="diffuse"><spectrum name="reflectance" value="700:1, 400:1"/></bsdf>"#), 4, "not valid"),
        (r#"<shape type="obj"><string name="filename" value="n.obj"/></shape>"#.into(), 4, "\"n.obj\" does not exist"),
        (r#"<shape type="obj"/>"#.into(), 4, "without the property \"filename\""),
        (r#"<include filename="../b.xml"/>"#.into(), 4, "leads out of the folder"),
        (format!("\n{one}\n{one}"), 6, "occurs twice"),
        ("\n<shape>".into(), 6, "invalid XML"),
        (twosided("a", "b") + &twosided("b", "a"), 4, "in a circle"),
    ] {
        let error = Imported::of(&body).error();
        assert!(error.contains(&format!("a.xml:{line}:")) && error.contains(what), "{body}: {error}");
    }
}

#[test]
fn xml_without_a_scene_is_refused() {
    let error = Imported::whole("<svg/>", &[]).error();
    assert!(error.contains("a.xml:1:1") && error.contains("<svg>") && error.contains("<scene>"), "{error}");
    let error = Imported::whole("<scene version=\"3.0.0\"/>", &[]).error();
    assert!(error.contains("no sensor"), "{error}");
}

#[test]
fn deep_and_circular_files_end_with_an_error() {
    let text = "<scene version=\"3.0.0\"><include filename=\"a.xml\"/></scene>";
    assert!(Imported::whole(text, &[]).error().contains("include each other"));
    let deep = format!("<scene version=\"3.0.0\">{}{}</scene>", "<bsdf>".repeat(5000), "</bsdf>".repeat(5000));
    assert!(Imported::whole(&deep, &[]).error().contains("nested too deeply"));
    let includes = format!("<scene version=\"3.0.0\">{}</scene>", "<include filename=\"b.xml\"/>".repeat(1001));
    let error = Imported::whole(&includes, &[("b.xml", b"<scene/>")]).error();
    assert!(error.contains("more than 1000 files"), "{error}");
    let parameter = |i: u32| format!("<default name=\"p{i}\" value=\"{}\"/>", format!("$p{}", i - 1).repeat(10));
    let parameters = (1..12).map(parameter).collect::<String>();
    let text = format!("<scene version=\"3.0.0\"><default name=\"p0\" value=\"xxxx\"/>{parameters}</scene>");
    assert!(Imported::whole(&text, &[]).error().contains("the parameters insert more than"));
}
