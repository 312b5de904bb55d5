//! How bright a picture is shown.

use super::picture::Picture;

/// The factor on luminance (cd/m²) that shows a picture neither dark nor burnt out: the log-average of the lit pixels goes to
/// middle grey (0.18), but not so far that more than 1 % of the pixels exceed white by more than half, nor that the whole
/// picture stays below one half. After Reinhard et al. 2002 (log-average), with percentiles against small bright lamps.
pub fn automatic(picture: &Picture) -> f64 {
    let mut lit: Vec<f64> = picture.xyz.iter().map(|xyz| xyz[1]).filter(|&y| y > 0.0 && y.is_finite()).collect();
    if lit.is_empty() {
        return 1.0;
    }
    lit.sort_by(f64::total_cmp);
    let quantile = |share: f64| lit[((lit.len() - 1) as f64 * share) as usize];
    // Pixels far darker than the bright ones (unlit background) say nothing about exposure.
    let floor = quantile(0.99) * 1e-3;
    let bright = &lit[lit.partition_point(|&y| y < floor)..];
    let log_mean = bright.iter().map(|y| y.ln()).sum::<f64>() / bright.len() as f64;
    let grey = 0.18 / log_mean.exp();
    let highlight = quantile(0.99);
    grey.clamp(0.5 / highlight, 1.5 / highlight)
}
