//! The analytical test cases 5.2–5.14 of CIE 171:2006, "Test cases to assess the accuracy of
//! lighting computer programs".
//!
//! The room is the box x 0…4, y 0…3, z −4…0 in m, with y up. Its surfaces have no thickness. The
//! expected values are computed from first principles; `data/SOURCES.md` names their source.

use super::{Case, ExpectedReading};
use abbe_spectra::math::elementary::sin_cos;
use serde::Deserialize;
use serde_json::{Value as Json, json};

/// The lamps of case 5.2 that have a table of intensities: their names and the texts of their
/// files.
pub(crate) const LAMPS: [(&str, &str); 2] =
    [("lamp_axial.ies", include_str!("lamp_axial.ies")), ("lamp_asymmetric.ies", include_str!("lamp_asymmetric.ies"))];

/// A scenario of the embedded file.
#[derive(Debug, Deserialize)]
struct Scenario {
    id: String,
    title: String,
    unit: String,
    relative: f64,
    absolute: f64,
    /// The factor from the unit of the values to lx.
    lx_per_unit: f64,
    geometry: Json,
    source: Json,
    points: Vec<Point>,
    values: Vec<SurfaceValue>,
    /// The luminance of the mask in cd/m², if it shines.
    mask_luminance: Option<f64>,
}

#[derive(Debug, Deserialize)]
struct Point {
    id: String,
    at: [f64; 3],
    normal: [f64; 3],
    expected: f64,
    published: Option<f64>,
}

#[derive(Debug, Deserialize)]
struct SurfaceValue {
    id: String,
    expected: f64,
    published: Option<f64>,
    /// The angle of incidence in degrees, in case 5.5.
    incidence_deg: Option<f64>,
    /// The reflectance, and the direct part of the mean illuminance in lx, in case 5.8.
    reflectance: Option<f64>,
    direct: Option<f64>,
}

/// A rectangle with an optional hole, in the plane where one coordinate is constant.
struct Wall {
    name: &'static str,
    axis: usize,
    at: f64,
    /// The lowest and the highest values of the other coordinates.
    span: [[f64; 2]; 2],
    /// The direction of the normal along the axis: into the room.
    inward: f64,
}

/// Returns all cases.
pub(crate) fn cases() -> Vec<Case> {
    let scenarios: Vec<Scenario> = serde_json::from_str(include_str!("cie171.json")).expect("the cases are JSON");
    scenarios.iter().map(Scenario::case).collect()
}

/// A scene under construction.
struct CaseScene {
    materials: serde_json::Map<String, Json>,
    objects: Vec<Json>,
    lights: Vec<Json>,
}

impl CaseScene {
    fn new() -> Self {
        let mut scene = Self { materials: serde_json::Map::new(), objects: Vec::new(), lights: Vec::new() };
        scene.surface(0.0);
        scene
    }

    /// Adds a diffuse material, and returns its name.
    fn surface(&mut self, reflectance: f64) -> String {
        let name = format!("reflectance {reflectance}");
        self.materials.insert(name.clone(), json!({"diffuse": {"reflectance": reflectance}}));
        name
    }

    /// Adds a quadrilateral. It faces `towards` if the point is given.
    fn quadrilateral(
        &mut self,
        name: &str,
        corners: &[[f64; 3]],
        material: &str,
        towards: Option<[f64; 3]>,
    ) -> &mut Json {
        let edge = |i: usize| std::array::from_fn::<f64, 3, _>(|k| corners[i][k] - corners[0][k]);
        let (a, b) = (edge(1), edge(2));
        let normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let away =
            towards.is_some_and(|point| (0..3).map(|k| normal[k] * (point[k] - corners[0][k])).sum::<f64>() < 0.0);
        let indices = if away { json!([[0, 2, 1], [0, 3, 2]]) } else { json!([[0, 1, 2], [0, 2, 3]]) };
        let shape = json!({"triangles": {"positions": corners, "indices": indices}});
        self.objects.push(json!({"name": name, "shape": shape, "material": material}));
        self.objects.last_mut().expect("an object was just added")
    }

    /// Adds the six surfaces of a room of this size. `reflectance` takes the name of a surface, and
    /// `opening` holds the corners of a hole in one of them.
    fn room(&mut self, [x, y, z]: [f64; 3], reflectance: impl Fn(&str) -> f64, opening: Option<&[[f64; 3]]>) {
        let walls = [
            Wall { name: "floor", axis: 1, at: 0.0, span: [[0.0, x], [-z, 0.0]], inward: 1.0 },
            Wall { name: "ceiling", axis: 1, at: y, span: [[0.0, x], [-z, 0.0]], inward: -1.0 },
            Wall { name: "north wall", axis: 2, at: -z, span: [[0.0, x], [0.0, y]], inward: 1.0 },
            Wall { name: "south wall", axis: 2, at: 0.0, span: [[0.0, x], [0.0, y]], inward: -1.0 },
            Wall { name: "west wall", axis: 0, at: 0.0, span: [[0.0, y], [-z, 0.0]], inward: 1.0 },
            Wall { name: "east wall", axis: 0, at: x, span: [[0.0, y], [-z, 0.0]], inward: -1.0 },
        ];
        for wall in walls {
            let material = self.surface(reflectance(wall.name));
            self.objects.extend(wall.object(&material, opening));
        }
    }

    /// Returns the text of the scene file with these meters.
    fn text(&self, meters: &[Json]) -> String {
        let Self { materials, objects, lights } = self;
        json!({"materials": materials, "objects": objects, "lights": lights, "meters": meters}).to_string()
    }
}

impl Wall {
    /// Returns the object, or `None` if the opening is as large as the wall.
    fn object(&self, material: &str, opening: Option<&[[f64; 3]]>) -> Option<Json> {
        let others: [usize; 2] = match self.axis {
            0 => [1, 2],
            1 => [0, 2],
            _ => [0, 1],
        };
        let [[a0, a1], [b0, b1]] = self.span;
        let inside = |corners: &&[[f64; 3]]| corners.iter().all(|corner| (corner[self.axis] - self.at).abs() < 1e-9);
        let parts = match opening.filter(inside) {
            None => vec![[a0, b0, a1, b1]],
            Some(corners) => {
                let end = |axis: usize, larger: fn(f64, f64) -> f64| {
                    corners.iter().map(|corner| corner[axis]).reduce(larger).unwrap_or(0.0)
                };
                let [h0, h1] = [f64::min, f64::max].map(|larger| end(others[0], larger));
                let [k0, k1] = [f64::min, f64::max].map(|larger| end(others[1], larger));
                vec![[a0, b0, h0, b1], [h1, b0, a1, b1], [h0, b0, h1, k0], [h0, k1, h1, b1]]
            }
        };
        let (mut positions, mut indices) = (Vec::new(), Vec::new());
        for [a0, b0, a1, b1] in parts.into_iter().filter(|[a0, b0, a1, b1]| a1 - a0 > 1e-9 && b1 - b0 > 1e-9) {
            let first = positions.len() as u32;
            for [a, b] in [[a0, b0], [a1, b0], [a1, b1], [a0, b1]] {
                let mut corner = [self.at; 3];
                (corner[others[0]], corner[others[1]]) = (a, b);
                positions.push(corner);
            }
            // The corners turn from the first to the second of the other axes. Their normal points
            // along the axis, except for the axis y.
            let along = if self.axis == 1 { -1.0 } else { 1.0 };
            let [one, other] = if along * self.inward > 0.0 { [1, 2] } else { [2, 1] };
            indices.push([first, first + one, first + other]);
            let [one, other] = if along * self.inward > 0.0 { [2, 3] } else { [3, 2] };
            indices.push([first, first + one, first + other]);
        }
        let shape = json!({"triangles": {"positions": positions, "indices": indices}});
        (!positions.is_empty()).then(|| json!({"name": self.name, "shape": shape, "material": material}))
    }
}

/// Returns the corners of a part of the geometry.
fn corners(part: &Json) -> Vec<[f64; 3]> {
    serde_json::from_value(part["corners"].clone()).unwrap_or_default()
}

/// Returns the material of a glazing.
fn pane(glazing: &Json) -> Json {
    let data = match glazing["model"].as_str().unwrap_or_default() {
        model if model.starts_with("clear") => json!({"ior": glazing["index"]}),
        model if model.starts_with("absorbing") => json!({
            "ior": glazing["index"], "thickness": glazing["thickness_m"], "absorption": glazing["absorption_per_m"]
        }),
        _ => json!({"transmittance": {"cosine_polynomial": glazing["coefficients"]}}),
    };
    json!({"thin_dielectric": data})
}

impl Scenario {
    fn case(&self) -> Case {
        let scenes = match self.id.split('/').next() {
            Some("5.5") => self.panes(),
            Some("5.8") if self.points.is_empty() => self.cubes(),
            _ => vec![self.scene()],
        };
        let Self { id, title, unit, relative, absolute, .. } = self;
        let (id, title, unit) = (id.clone(), title.clone(), unit.clone());
        Case { id, title, unit, scenes, relative: *relative, absolute: *absolute }
    }

    fn number(&self, key: &str) -> f64 {
        self.source[key].as_f64().unwrap_or(0.0)
    }

    /// Returns the only scene of a case with points or surfaces.
    fn scene(&self) -> (String, Vec<ExpectedReading>) {
        let mut scene = CaseScene::new();
        let (geometry, source) = (&self.geometry, &self.source);
        let black = |_: &str| 0.0;
        let room = [4.0, 3.0, 4.0];
        match &self.id[..3] {
            "5.2" => self.add_lamp(&mut scene),
            "5.3" => {
                self.add_area_lamp(&mut scene);
                if geometry.get("room").is_some() {
                    scene.room(room, black, None);
                }
            }
            "5.4" if source.get("at").is_some() => {
                scene.room(room, black, None);
                self.add_lamp(&mut scene);
            }
            "5.4" if geometry.get("lamp").is_some() => {
                scene.room(room, black, None);
                self.add_area_lamp(&mut scene);
            }
            "5.6" => {
                let material = scene.surface(geometry["S2"]["reflectance"].as_f64().unwrap_or(0.0));
                scene.quadrilateral("S2", &corners(&geometry["S2"]), &material, None);
                let illuminance = self.number("horizontal_illuminance_lx");
                scene.lights.push(json!({"directional": {
                    "toward": source["toward"], "spectrum": "D65", "illuminance": illuminance
                }}));
            }
            "5.7" => {
                let black = scene.surface(0.0);
                let lamp = scene.quadrilateral("S2", &corners(&geometry["S2"]), &black, Some([2.0, 1.0, -2.0]));
                lamp["emission"] = json!({"spectrum": "D65", "luminance": self.number("luminance_cd_m2")});
                if let (Ok(low), Ok(high)) = (
                    serde_json::from_value::<[f64; 3]>(geometry["box"]["min"].clone()),
                    serde_json::from_value::<[f64; 3]>(geometry["box"]["max"].clone()),
                ) {
                    let size: [f64; 3] = std::array::from_fn(|k| high[k] - low[k]);
                    let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * (high[k] + low[k]));
                    scene.objects.push(json!({
                        "name": "box", "shape": {"box": {"size": size}}, "material": black,
                        "transform": [{"translate": middle}]
                    }));
                }
            }
            "5.8" => {
                let reflectance = &geometry["reflectance"];
                let size = if reflectance.is_object() { [5.0, 3.0, 4.0] } else { [4.0; 3] };
                let of = |name: &str| reflectance.get(name).unwrap_or(reflectance).as_f64().unwrap_or(0.0);
                scene.room(size, of, None);
                self.add_lamp(&mut scene);
            }
            _ => self.add_daylight(&mut scene, room),
        }
        let (mut meters, mut expected) = (Vec::new(), Vec::new());
        let reading = |id: &str, value: f64, published: Option<f64>, scale: f64| ExpectedReading {
            id: id.to_string(),
            value,
            published,
            scale,
            offset: 0.0,
        };
        for point in &self.points {
            meters.push(json!({"name": point.id, "points": [point.at], "normal": point.normal}));
            expected.push(reading(&point.id, point.expected, point.published, 1.0 / self.lx_per_unit));
        }
        for value in &self.values {
            // The other values are sums over surfaces.
            if scene.objects.iter().any(|object| object["name"] == value.id.as_str()) {
                let (quantity, side) = ("luminous_flux", "front");
                meters.push(json!({"name": value.id, "surface": value.id, "quantity": quantity, "side": side}));
                expected.push(reading(&value.id, value.expected, value.published, 1.0));
            }
        }
        (scene.text(&meters), expected)
    }

    /// Adds a lamp without extent.
    fn add_lamp(&self, scene: &mut CaseScene) {
        let (at, flux) = (&self.source["at"], self.number("flux_lm"));
        if let Some(file) = self.source.get("file") {
            scene.lights.push(json!({"ies": {
                "at": at, "toward": [0, -1, 0], "c0": [1, 0, 0], "path": file, "spectrum": "D65"
            }}));
        } else if self.source.get("I0_cd").is_some() {
            // A small square stands for the lamp; its intensity follows the cosine.
            let material = scene.surface(0.0);
            scene.objects.push(json!({
                "name": "lamp", "shape": {"rectangle": {"width": 0.001, "height": 0.001}}, "material": material,
                "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": 180}}, {"translate": at}],
                "emission": {"spectrum": "D65", "luminous_flux": flux}
            }));
        } else {
            scene.lights.push(json!({"point": {"at": at, "spectrum": "D65", "luminous_flux": flux}}));
        }
    }

    fn add_area_lamp(&self, scene: &mut CaseScene) {
        let (lamp, material) = (&self.geometry["lamp"], scene.surface(0.0));
        let corners = corners(lamp);
        let faces: [f64; 3] = serde_json::from_value(lamp["faces"].clone()).unwrap_or_default();
        let towards = corners.first().map(|corner| std::array::from_fn(|k| corner[k] + faces[k]));
        let object = scene.quadrilateral("lamp", &corners, &material, towards);
        object["emission"] = json!({"spectrum": "D65", "luminance": self.number("luminance_cd_m2")});
    }

    /// Adds a sky, a black room with an opening, its glazing, and an overhang or a screen outside.
    fn add_daylight(&self, scene: &mut CaseScene, room: [f64; 3]) {
        let (geometry, source) = (&self.geometry, &self.source);
        let lit = geometry["ground"].as_str().is_some_and(|ground| ground.starts_with("uniform luminance 0.3"));
        scene.lights.push(json!({"sky": {
            "type": source["type"].as_u64().unwrap_or(16),
            "sun_elevation": source["sun_elevation_deg"].as_f64().unwrap_or(60.0),
            "sun_azimuth": source["sun_azimuth_deg"].as_f64().unwrap_or(180.0),
            "illuminance": self.number("horizontal_illuminance_lx"),
            "ground_reflectance": if lit { 0.3 } else { 0.0 }
        }}));
        let opening = corners(&geometry["opening"]);
        scene.room(room, |_| 0.0, Some(&opening));
        let glazing = &geometry["opening"]["glazing"];
        if glazing.is_object() {
            scene.materials.insert("pane".to_string(), pane(glazing));
            scene.quadrilateral("pane", &opening, "pane", None);
        }
        let mask = &geometry["mask"];
        if mask.is_object() {
            let is = mask["is"].as_str().unwrap_or_default();
            let material = scene.surface(if is.contains("reflectance 0.5") { 0.5 } else { 0.0 });
            let object = scene.quadrilateral("mask", &corners(mask), &material, Some([2.0, 1.5, -2.0]));
            if let Some(luminance) = self.mask_luminance {
                object["emission"] = json!({"spectrum": "D65", "luminance": luminance});
            }
        }
    }

    /// Case 5.5: parallel light falls through a pane. The unit of the values is the illuminance
    /// without the pane.
    fn panes(&self) -> Vec<(String, Vec<ExpectedReading>)> {
        const LX: f64 = 1000.0;
        let of_angle = |value: &SurfaceValue| {
            let (sin, cos) = sin_cos(value.incidence_deg.unwrap_or(0.0).to_radians());
            let mut scene = CaseScene::new();
            scene.materials.insert("pane".to_string(), pane(&self.geometry["glazing"]));
            let corners = [[-50.0, 1.0, 50.0], [50.0, 1.0, 50.0], [50.0, 1.0, -50.0], [-50.0, 1.0, -50.0]];
            scene.quadrilateral("pane", &corners, "pane", None);
            scene
                .lights
                .push(json!({"directional": {"toward": [sin, -cos, 0.0], "spectrum": "D65", "illuminance": LX}}));
            // The meter faces the light, so that it reads the light at any angle.
            let meter = json!({"name": value.id, "points": [[0, 0, 0]], "normal": [-sin, cos, 0.0]});
            let (id, scale) = (value.id.clone(), 1.0 / LX);
            let expected =
                ExpectedReading { id, value: value.expected, published: value.published, scale, offset: 0.0 };
            (scene.text(&[meter]), vec![expected])
        };
        self.values.iter().map(of_angle).collect()
    }

    /// Case 5.8: the mean indirect illuminance of a cube for several reflectances.
    fn cubes(&self) -> Vec<(String, Vec<ExpectedReading>)> {
        let of_reflectance = |value: &SurfaceValue| {
            let mut scene = CaseScene::new();
            scene.room([4.0; 3], |_| value.reflectance.unwrap_or(0.0), None);
            self.add_lamp(&mut scene);
            // By symmetry, all surfaces have the same mean.
            let meter = json!({"name": value.id, "surface": "floor", "side": "front"});
            let (id, offset) = (value.id.clone(), value.direct.unwrap_or(0.0));
            let expected =
                ExpectedReading { id, value: value.expected, published: value.published, scale: 1.0, offset };
            (scene.text(&[meter]), vec![expected])
        };
        self.values.iter().map(of_reflectance).collect()
    }
}
