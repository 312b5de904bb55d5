//! Mixes the light groups of a picture with other gains. Light is additive, so the result is the
//! picture of a scene in which the lights of a group have another power.

use abbe_spectra::colour::linear_srgb_to_xyz;
use abbe_spectra::error::{Error, Result};
use abbe_transport::sensor::Picture;
use abbe_transport::sensor::layers::LayerChannel;

#[derive(Debug, Clone, PartialEq)]
pub struct LightGain {
    pub group: String,
    /// The factors of red, green and blue (linear Rec. 709).
    pub rgb: [f64; 3],
}

/// The names of the channels of light groups begin with this prefix.
const PREFIX: &str = "light.";

const COLOURS: [&str; 3] = [".R", ".G", ".B"];

pub fn light_groups(picture: &Picture) -> Vec<&str> {
    let names = picture.layers.channels.iter().map(|channel| channel.name.as_str());
    names.filter_map(|name| name.strip_prefix(PREFIX)?.strip_suffix(COLOURS[0])).collect()
}

/// Returns the picture with these gains of its light groups, and 1 for all others. Its errors are
/// unknown, and it has no layers of path classes and no spectral bands. Returns an input error if
/// the picture has no light groups, or if a gain names an unknown one.
pub fn relight(picture: &Picture, gains: &[LightGain]) -> Result<Picture> {
    let groups = light_groups(picture);
    if groups.is_empty() {
        let error = Error::input("the picture has no layers of light groups");
        return Err(error.expected("a picture that `abbe render --layers lights` has written"));
    }
    if let Some(gain) = gains.iter().find(|gain| !groups.contains(&gain.group.as_str())) {
        let expected = format!("one of {}", groups.join(", "));
        return Err(Error::unknown_name("light group", &gain.group, groups).expected(expected));
    }
    let factor = |group: &str, c: usize| {
        gains.iter().filter(|gain| gain.group == group).map(|gain| gain.rgb[c]).next_back().unwrap_or(1.0)
    };
    let mut relit = Picture::black(picture.width, picture.height);
    let mut rgb = vec![[0.0; 3]; picture.xyz.len()];
    for channel in &picture.layers.channels {
        if channel.name.starts_with("path.") {
            continue;
        }
        let component = COLOURS.iter().position(|colour| channel.name.ends_with(colour));
        let (Some(layer), Some(c)) = (channel.name.strip_prefix(PREFIX), component) else {
            relit.layers.channels.push(channel.clone());
            continue;
        };
        let gain = factor(&layer[..layer.len() - COLOURS[c].len()], c);
        let values: Vec<f32> = channel.values.iter().map(|&value| (f64::from(value) * gain) as f32).collect();
        rgb.iter_mut().zip(&channel.values).for_each(|(rgb, &value)| rgb[c] += f64::from(value) * gain);
        relit.layers.channels.push(LayerChannel { name: channel.name.clone(), values });
    }
    relit.xyz.iter_mut().zip(rgb).for_each(|(xyz, rgb)| *xyz = linear_srgb_to_xyz(rgb));
    relit.layers.mattes.clone_from(&picture.layers.mattes);
    Ok(relit)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> Picture {
        let mut picture = Picture::black(2, 1);
        let mut add = |name: &str, values: [f32; 2]| {
            picture.layers.channels.push(LayerChannel { name: name.to_string(), values: values.to_vec() });
        };
        for (c, colour) in ["R", "G", "B"].into_iter().enumerate() {
            add(&format!("light.lamp.{colour}"), [1.0 + c as f32, 0.0]);
            add(&format!("light.sun.{colour}"), [0.5, 2.0]);
            add(&format!("path.direct.{colour}"), [1.5, 2.0]);
        }
        add("depth.Z", [3.0, 4.0]);
        picture
    }

    fn gain(group: &str, rgb: [f64; 3]) -> LightGain {
        LightGain { group: group.to_string(), rgb }
    }

    #[test]
    fn gains_multiply_the_light_of_their_group() {
        let gains = [gain("lamp", [2.0, 1.0, 0.0]), gain("sun", [0.0; 3])];
        let relit = relight(&picture(), &gains).unwrap();
        let expected = [[2.0, 2.0, 0.0], [0.0; 3]].map(linear_srgb_to_xyz);
        for (xyz, expected) in relit.xyz.iter().zip(expected) {
            (0..3).for_each(|c| assert!((xyz[c] - expected[c]).abs() < 1e-12, "{xyz:?}"));
        }
        let names: Vec<&str> = relit.layers.channels.iter().map(|channel| channel.name.as_str()).collect();
        assert!(names.contains(&"depth.Z") && !names.iter().any(|name| name.starts_with("path.")), "{names:?}");
        assert_eq!(light_groups(&relit), ["lamp", "sun"]);
    }

    #[test]
    fn unknown_groups_and_pictures_without_groups_are_refused() {
        let error = relight(&picture(), &[gain("lmap", [1.0; 3])]).unwrap_err().to_string();
        assert!(error.contains("lmap") && error.contains("one of lamp, sun"), "{error}");
        let error = relight(&Picture::black(1, 1), &[]).unwrap_err().to_string();
        assert!(error.contains("--layers lights"), "{error}");
    }
}
