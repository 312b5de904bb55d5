//! Tests of BSDFs and of their mixtures.

use super::{Bsdf, MixBsdf};
use crate::glass::RefractiveIndex;
use crate::texture::{
    Filter, ImagePattern, ImageSize, LookupRandom, ScalarTexture, SurfaceScalar, TexturePoint, UvTransform, Wrap,
};
use abbe_spectra::math::random::ONE_MINUS_ULP;
use abbe_spectra::spectrum::{Outside, Spectrum};

#[test]
fn fractions_outside_0_to_1_are_refused_and_named() {
    for bad in [-0.1, 1.5, f64::NAN] {
        let message = Bsdf::diffuse(Spectrum::constant(bad)).unwrap_err().to_string();
        assert!(message.contains("reflectance") && message.contains("from 0 to 1"), "{message}");
        assert!(Bsdf::mirror(Spectrum::constant(bad)).is_err());
        let index = RefractiveIndex::constant(1.5).unwrap();
        assert!(Bsdf::glossy(Spectrum::constant(bad), index, 0.1).is_err());
    }
    let spike = Spectrum::table(&[500.0, 500.5, 501.0], &[0.5, 1.2, 0.5], Outside::Hold).unwrap();
    assert!(Bsdf::diffuse(spike).unwrap_err().to_string().contains("a reflectance of 1.2"));
    assert!(Bsdf::conductor(Spectrum::constant(-1.0), Spectrum::constant(2.0), 0.0).is_err());
    assert!(Bsdf::conductor(Spectrum::constant(0.2), Spectrum::constant(3.0), 2.0).is_err());
}

#[test]
fn a_simple_bsdf_is_its_own_only_component() {
    let bsdf = Bsdf::diffuse(Spectrum::constant(0.5)).unwrap();
    assert_eq!(bsdf.at(0.7).model, &bsdf);
    assert_eq!(bsdf.components().count(), 1);
}

fn grey(reflectance: f64) -> Bsdf {
    Bsdf::diffuse(Spectrum::constant(reflectance)).unwrap()
}

#[test]
fn weights_must_be_numbers_from_0_up_and_one_must_be_positive() {
    for weights in [vec![], vec![0.0], vec![1.0, -1.0], vec![f64::NAN], vec![f64::INFINITY]] {
        let parts = weights.iter().map(|&weight| (weight, Bsdf::Absorber)).collect();
        assert!(MixBsdf::new(parts).is_err(), "{weights:?}");
    }
}

#[test]
fn nested_mixtures_are_flattened() {
    let inner = Bsdf::mix(vec![(1.0, grey(0.1)), (3.0, grey(0.2))]).unwrap();
    let mix = MixBsdf::new(vec![(2.0, grey(0.3)), (0.0, grey(0.9)), (2.0, inner)]).unwrap();
    assert_eq!(mix.components(), &[grey(0.3), grey(0.1), grey(0.2)]);
    assert_eq!(mix.weighted_components().map(|(weight, _)| weight).collect::<Vec<_>>(), [0.5, 0.125, 0.375]);
}

#[test]
fn sampling_follows_the_weights_and_reuses_the_number() {
    let mix = MixBsdf::new(vec![(1.0, grey(0.1)), (3.0, grey(0.2))]).unwrap();
    for (u, component, rest) in [(0.0, 0, 0.0), (0.125, 0, 0.5), (0.25, 1, 0.0), (0.625, 1, 0.5)] {
        let mut number = u;
        assert_eq!((mix.sample_index(&mut number), number), (component, rest), "u = {u}");
    }
    let mut last = ONE_MINUS_ULP;
    assert_eq!(mix.sample_index(&mut last), 1);
    assert!(last < 1.0);
}

fn picture(values: &[f32]) -> ScalarTexture {
    let size = ImageSize { width: values.len(), height: 1 };
    let pattern = ImagePattern::new(size, [Wrap::Clamp; 2], Filter::Nearest, UvTransform::IDENTITY).unwrap();
    ScalarTexture::from_values(pattern, values.to_vec())
}

fn frequencies(mix: &MixBsdf, u: f64) -> Vec<f64> {
    let (mut counts, mut random, point) =
        (vec![0.0; mix.components().len()], LookupRandom::new(0.6), TexturePoint::new([u, 0.5]));
    for _ in 0..40_000 {
        let found = mix.component_at(&point, &mut random);
        counts[mix.components().iter().position(|component| component == found).unwrap()] += 1.0 / 40_000.0;
    }
    counts
}

fn close(found: &[f64], expected: &[f64]) -> bool {
    found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.01)
}

#[test]
fn textured_weights_select_components_at_each_point() {
    let inner = Bsdf::mix(vec![(1.0, grey(0.1)), (3.0, grey(0.2))]).unwrap();
    let weight = SurfaceScalar::Textured(picture(&[0.0, 1.0, 3.0]));
    let mix = MixBsdf::textured(vec![(weight, inner), (SurfaceScalar::Uniform(1.0), grey(0.3))]).unwrap();
    for (u, expected) in [(0.1, [0.0, 0.0, 1.0]), (0.5, [0.125, 0.375, 0.5]), (0.9, [0.1875, 0.5625, 0.25])] {
        let found = frequencies(&mix, u);
        assert!(close(&found, &expected), "{u}: {found:?}");
    }
}

/// Between two levels of roughness, the mean of the selected levels is the roughness.
#[test]
fn textured_roughness_selects_the_neighbouring_levels() {
    let mix = MixBsdf::of_roughness(picture(&[0.25, 0.335]), |roughness| Ok(grey(roughness))).unwrap();
    assert_eq!(mix.components(), [8.0, 9.0, 10.0, 11.0].map(|level| grey(level / 32.0)));
    assert!(close(&frequencies(&mix, 0.2), &[1.0, 0.0, 0.0, 0.0]));
    let found = frequencies(&mix, 0.8);
    assert!(close(&found, &[0.0, 0.0, 0.28, 0.72]), "{found:?}");
    assert!(MixBsdf::of_roughness(picture(&[0.5, 1.5]), |roughness| Ok(grey(roughness))).is_err());
}
