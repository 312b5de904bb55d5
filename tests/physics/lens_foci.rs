//! Image positions of lenses of real glass: best focus and image height of points in single
//! spectral lines, compared with exactly traced rays; and the illuminance towards the corners.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{diffuse, render};
use abbe_format::{self as format, resolve};
use abbe_optics::glass::lines;
use abbe_optics::lens::{ApertureCheck, Lens, LensRay, MonochromaticLens, TraceDirection, catalogue};
use abbe_session::render::Integrator;
use glam::{DVec2, DVec3};
use serde_json::{Value, json};

const FILM: usize = 64;

/// Returns positions in mm on the sensor with their Y.
fn rendered(scene: &Value, passes: u64, pixel_mm: f64) -> Vec<(DVec2, f64)> {
    let picture = render(scene, Integrator::Path, passes).picture;
    let middle = 0.5 * FILM as f64;
    // The image is inverted: right in the picture is −x on the sensor.
    let place = |i: usize| DVec2::new(middle - (i % FILM) as f64 - 0.5, (i / FILM) as f64 + 0.5 - middle) * pixel_mm;
    picture.xyz.iter().enumerate().map(|(i, xyz)| (place(i), xyz[1])).collect()
}

/// Returns a lens of these surfaces in its scene form and as a traced lens.
fn own_lens(surfaces: Value) -> (Value, Lens) {
    let prescription = json!({ "surfaces": surfaces });
    let (file, source) = format::parse_prescription(&prescription.to_string(), "lens.json".as_ref()).unwrap();
    (prescription, resolve::lone_lens(&file, &source).unwrap())
}

/// Emitting balls at positions in mm (z behind the first vertex), in the light of one line, seen
/// through a lens at an f-number.
fn points(lens: &Value, f_number: f64, focus_mm: f64, (nm, sensor_mm): (f64, f64), balls: &[(DVec3, f64)]) -> Value {
    let ball = |&(center, radius): &(DVec3, f64)| {
        json!({ "shape": { "sphere": { "center": center.to_array(), "radius": radius } }, "material": "black",
                "emission": { "spectrum": { "lines": [{ "nm": nm, "power": 1 }] }, "radiance": 1 } })
    };
    json!({
        "unit": "mm",
        "camera": { "from": [0, 0, 0], "at": [0, 0, -1],
                    "lens": { "system": { "prescription": lens, "focus_distance": focus_mm, "f_number": f_number, "sensor_height_mm": sensor_mm } } },
        "film": { "width": FILM, "height": FILM },
        "materials": { "black": diffuse(0.0) },
        "objects": balls.iter().map(ball).collect::<Vec<_>>(),
        "render": { "photons": 100 }
    })
}

/// Traces rays from a point of the scene through a fine grid on the lens's first surface. Returns
/// those that pass.
fn traced<'a>(at: &'a MonochromaticLens<'_>, point: DVec3) -> impl Iterator<Item = LensRay> + 'a {
    const SIDE: u32 = 200;
    let reach = at.lens().surfaces()[0].semi_aperture_mm;
    let place = move |i: u32| reach * (2.0 * (f64::from(i) + 0.5) / f64::from(SIDE) - 1.0);
    (0..SIDE * SIDE).filter_map(move |i| {
        let aim = DVec3::new(place(i % SIDE), place(i / SIDE), 0.0);
        let ray = LensRay { origin: point, direction: (aim - point).normalize() };
        at.trace(ray, TraceDirection::ToSensor, ApertureCheck::Enforced).ok()
    })
}

/// Returns the position of the narrowest cross-section of the ray bundle of an axial point, in mm
/// behind the last vertex.
fn traced_focus_mm(lens: &Lens, nm: f64, point: DVec3) -> f64 {
    let (mut above, mut below) = (0.0, 0.0);
    let at = lens.at(nm);
    for ray in traced(&at, point) {
        let place = ray.at_z(lens.length_mm()).truncate();
        let slope = ray.direction.truncate() / ray.direction.z;
        above -= place.dot(slope);
        below += slope.length_squared();
    }
    above / below
}

/// Measures the same position from three renders with the sensor `step_mm` before, at and behind
/// the focus of the d line. The mean square size of a spot is a parabola in the sensor's position.
fn rendered_focus_mm(name: &str, f_number: f64, nm: f64, point: DVec3, step_mm: f64) -> f64 {
    let lens = catalogue::find(name).unwrap();
    let at_d = lens.at(lines::D_NM);
    let paraxial = at_d.paraxial().unwrap();
    let middle_mm = at_d.image_distance_mm(-point.z).unwrap();
    let sensor_mm = 3.6 * step_mm / f_number;
    let pixel_mm = sensor_mm / FILM as f64;
    let magnification = paraxial.efl_mm / (-point.z - paraxial.efl_mm);
    let [before, there, behind] = [-1.0, 0.0, 1.0].map(|sign| {
        // Newton's equation gives the object distance whose d focus lies there.
        let image_mm = middle_mm + sign * step_mm;
        let focus_mm = paraxial.efl_mm.powi(2) / (image_mm - paraxial.bfd_mm) - paraxial.front_focus_z_mm;
        let ball = (point, 4.0 * pixel_mm / magnification);
        let scene = points(&json!(name), f_number, focus_mm, (nm, sensor_mm), &[ball]);
        let spot = rendered(&scene, 64, pixel_mm);
        let whole: f64 = spot.iter().map(|(_, y)| y).sum();
        let centre = spot.iter().map(|(place, y)| *place * *y).sum::<DVec2>() / whole;
        spot.iter().map(|(place, y)| place.distance_squared(centre) * y).sum::<f64>() / whole
    });
    middle_mm + 0.5 * step_mm * (before - behind) / (before - 2.0 * there + behind)
}

#[test]
#[ignore = "nightly: 16 seconds of CPU time"]
fn points_are_sharpest_at_the_traced_focus_of_each_line() {
    const POINT: DVec3 = DVec3::new(0.0, 0.0, -2000.0);
    const F_NUMBER: f64 = 10.0;
    for (name, step_mm) in [("singlet", 2.0), ("cemented achromat", 1.0)] {
        let lens = catalogue::find(name).unwrap().stopped_down(F_NUMBER).unwrap();
        let [[f, traced_f], [c, traced_c]] = [lines::F_NM, lines::C_NM].map(|nm| {
            let focus = rendered_focus_mm(name, F_NUMBER, nm, POINT, step_mm);
            let traced = traced_focus_mm(&lens, nm, POINT);
            println!("{name}, {nm:.1} nm: sharpest {focus:.3} mm behind the lens, exact rays {traced:.3} mm");
            assert!((focus / traced - 1.0).abs() < 0.02, "{name}, {nm} nm: {focus} and {traced}");
            [focus, traced]
        });
        let (found, expected) = (f - c, traced_f - traced_c);
        println!("{name}: F′ − C′ {found:+.4} mm rendered, {expected:+.4} mm traced");
        assert!((found / expected - 1.0).abs() < 0.03, "{name}: {found} and {expected}");
    }
}

#[test]
fn lateral_colour_in_a_grid_of_points_is_the_traced_one() {
    // A lens far in front of its stop images each colour at another size (lateral colour).
    let surfaces = json!([
        { "radius_mm": 80, "thickness_mm": 6, "ior": "N-SF5", "semi_aperture_mm": 20 },
        { "radius_mm": -150, "thickness_mm": 25, "ior": 1, "semi_aperture_mm": 20 },
        { "radius_mm": 0, "thickness_mm": 0, "ior": 1, "semi_aperture_mm": 5, "stop": true }]);
    let (prescription, lens) = own_lens(surfaces);
    const F_NUMBER: f64 = 16.0;
    const SENSOR_MM: f64 = 36.0;
    const FOCUS_MM: f64 = 1000.0;
    let pixel_mm = SENSOR_MM / FILM as f64;
    let lens = lens.stopped_down(F_NUMBER).unwrap();
    let sensor_z_mm = lens.length_mm() + lens.at(lines::D_NM).image_distance_mm(FOCUS_MM).unwrap();
    let step_mm = 0.3 * SENSOR_MM / sensor_z_mm * FOCUS_MM;
    let grid = (0..9).map(|i| DVec3::new(f64::from(i % 3 - 1) * step_mm, f64::from(i / 3 - 1) * step_mm, -FOCUS_MM));
    let balls: Vec<(DVec3, f64)> = grid.map(|place| (place, 6.0)).collect();
    let mut worst: [f64; 2] = [0.0; 2];
    let mut shifts = vec![[DVec2::ZERO; 2]; balls.len()];
    for (nm, sign) in [(lines::F_NM, 1.0), (lines::C_NM, -1.0)] {
        let spots = rendered(&points(&prescription, F_NUMBER, FOCUS_MM, (nm, SENSOR_MM), &balls), 128, pixel_mm);
        let at = lens.at(nm);
        for ((point, _), shift) in balls.iter().zip(&mut shifts) {
            let (sum, count) = traced(&at, *point)
                .fold((DVec2::ZERO, 0.0), |(sum, count), ray| (sum + ray.at_z(sensor_z_mm).truncate(), count + 1.0));
            let expected = sum / count / pixel_mm;
            let near = |(place, _): &&(DVec2, f64)| (*place / pixel_mm - expected).abs().max_element() < 8.0;
            let (sum, whole) = spots
                .iter()
                .filter(near)
                .fold((DVec2::ZERO, 0.0), |(sum, whole), (place, y)| (sum + *place * *y, whole + y));
            let found = sum / whole / pixel_mm;
            worst[0] = worst[0].max((found - expected).length());
            shift[0] += sign * found;
            shift[1] += sign * expected;
        }
    }
    let largest = shifts.iter().map(|shift| shift[1].length()).fold(0.0, f64::max);
    worst[1] = shifts.iter().map(|shift| (shift[0] - shift[1]).length()).fold(0.0, f64::max);
    println!(
        "grid: places within {:.3} pixels, lateral colour (up to {largest:.3} pixels) within {:.3}",
        worst[0], worst[1]
    );
    assert!(largest > 0.3, "the lens has lateral colour");
    assert!(worst.into_iter().all(|worst| worst < 0.1), "{worst:?}");
}

/// Returns Y along the diagonal of the picture under uniform light, with the transmittance that
/// exact rays from the same sensor positions have.
fn falloff(prescription: &Value, lens: &Lens, sensor_mm: f64) -> Vec<[f64; 3]> {
    let pixel_mm = sensor_mm / FILM as f64;
    let scene = json!({
        "unit": "mm",
        "camera": { "from": [0, 0, 0], "at": [0, 0, -1],
                    "lens": { "system": { "prescription": prescription, "focus_distance": 1e6, "sensor_height_mm": sensor_mm } } },
        "film": { "width": FILM, "height": FILM },
        "materials": { "black": diffuse(0.0) },
        "objects": [ { "shape": { "sphere": { "radius": 1, "center": [0, 0, 5000] } }, "material": "black" } ],
        "lights": [ { "environment": { "spectrum": { "lines": [{ "nm": 587.5618, "power": 1 }] }, "illuminance": 100 } } ],
        "render": { "photons": 100 }
    });
    let pixels = rendered(&scene, 96, pixel_mm);
    let at = lens.at(lines::D_NM);
    let distance_mm = at.image_distance_mm(1e6).unwrap();
    let last_mm = lens.length_mm();
    let reach = 1.5 * lens.surfaces()[lens.surfaces().len() - 1].semi_aperture_mm;
    let through = |radius_mm: f64| {
        const SIDE: u32 = 300;
        let place = |i: u32| reach * (2.0 * (f64::from(i) + 0.5) / f64::from(SIDE) - 1.0);
        let origin = DVec3::new(radius_mm, 0.0, last_mm + distance_mm);
        let share = |i: u32| {
            let direction = (DVec3::new(place(i % SIDE), place(i / SIDE), last_mm) - origin).normalize();
            let passes =
                at.trace(LensRay { origin, direction }, TraceDirection::ToScene, ApertureCheck::Enforced).is_ok();
            if passes { direction.z.powi(4) } else { 0.0 }
        };
        (0..SIDE * SIDE).map(share).sum::<f64>()
    };
    // Rings four pixels wide: means over hundreds of pixels.
    let on_axis = through(0.0);
    let ring = |i: usize| {
        let (from, to) = (4.0 * i as f64 * pixel_mm, 4.0 * (i + 1) as f64 * pixel_mm);
        let inside: Vec<&(DVec2, f64)> =
            pixels.iter().filter(|(place, _)| (from..to).contains(&place.length())).collect();
        let count = inside.len() as f64;
        let radius_mm = inside.iter().map(|(place, _)| place.length()).sum::<f64>() / count;
        let y = inside.iter().map(|(_, y)| y).sum::<f64>() / count / (100.0 / std::f64::consts::PI);
        let cos = (radius_mm / distance_mm).atan().cos();
        [y, through(radius_mm) / on_axis, cos.powi(4)]
    };
    (0..FILM / 8).map(ring).collect()
}

#[test]
fn illuminance_falls_off_by_cos4_and_vignetting() {
    // A small stop as the last surface is its own exit pupil, so the falloff is cos⁴ alone.
    let surfaces = json!([
        { "radius_mm": 100, "thickness_mm": 12, "ior": "N-BK7", "semi_aperture_mm": 30 },
        { "radius_mm": -100, "thickness_mm": 1, "ior": 1, "semi_aperture_mm": 30 },
        { "radius_mm": 0, "thickness_mm": 0, "ior": 1, "semi_aperture_mm": 2, "stop": true }]);
    let (behind, lens) = own_lens(surfaces);
    for [y, traced, cos4] in falloff(&behind, &lens, 80.0) {
        println!("behind a small stop: {y:.4}, exact rays {traced:.4}, cos⁴ {cos4:.4}");
        assert!((y / traced - 1.0).abs() < 0.01 && (y / cos4 - 1.0).abs() < 0.01);
    }
    let double_gauss = catalogue::find("double gauss").unwrap();
    let rings = falloff(&json!("double gauss"), double_gauss, 50.0);
    for [y, traced, cos4] in &rings {
        println!("double Gauss at f/2: {y:.4}, exact rays {traced:.4}, cos⁴ alone {cos4:.4}");
        assert!((y - traced).abs() < 0.01);
    }
    assert!(rings.last().unwrap()[0] < 0.9 * rings.last().unwrap()[2], "its rims cut off the corners");
}
