//! The results of a study as one self-contained HTML page.

use maud::{Markup, PreEscaped, html};

use super::convergence::ConvergencePoint;
use super::curves::ConvergenceCurve;
use super::effects::{AblationResult, EffectAblation, EffectStudy, RenderCost};
use super::reference::MeanEstimate;
use super::reference_choice::ChosenReference;
use super::report::{StudyReport, signed, theory};
use super::study_scene::RenderSettings;
use super::study_scene::integrator_title;
use super::time_fractions::TIME_FRACTIONS;
use abbe_session::output::axis::power_of_ten;
use abbe_session::output::compare::DeltaE;
use abbe_session::output::comparison_page::colour_differences;
use abbe_session::output::data_uri::data_uri;
use abbe_session::output::page::document;
use abbe_session::output::png::encode;
use abbe_session::output::selection::Selection;
use abbe_session::render::{Integrator, Job};
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::{log2, log10};
use abbe_transport::sensor::{Development, DisplayImage, Picture, develop_with_reach, exposure};

/// The pictures of the page. All pictures have the exposure and the reach of the reference.
#[derive(Debug)]
pub(super) struct StudyPictures<'a> {
    development: Development,
    exposure: f64,
    reach: f64,
    /// The pictures for comparison and their names: the reference, photon mapping, the path tracer,
    /// and then one without each effect.
    full: Vec<(String, &'a Picture)>,
    whole: &'a Picture,
}

/// Indices of certain pictures in the list of pictures for comparison.
const REFERENCE: usize = 0;
const PHOTONS: usize = 1;
const FIRST_EFFECT: usize = 3;

/// The largest width of a thumbnail in pixels.
const THUMBNAIL: usize = 160;

impl<'a> StudyPictures<'a> {
    pub(super) fn of(
        job: &Job,
        reference: &'a ChosenReference,
        curves: &'a [ConvergenceCurve; 2],
        effects: &'a EffectStudy,
    ) -> Self {
        let film = &job.scene.film;
        let development =
            Development { white: film.white, gamut: film.gamut, tone: film.tone, ..Development::default() };
        let reference = &reference.reference.picture;
        let (exposure, reach) = (exposure::automatic(reference), development.reach(reference));
        let of_curve = |curve: &'a ConvergenceCurve| {
            let name = format!("{}, {}", integrator_title(curve.integrator), passes(curve.stats.passes));
            (name, &curve.picture)
        };
        let without = effects.on.iter().filter_map(|effect| {
            Some((format!("without {}, {}", effect.name, passes(effects.passes)), effect.picture.as_ref()?))
        });
        let first = [("reference".to_string(), reference), of_curve(&curves[0]), of_curve(&curves[1])];
        let full = first.into_iter().chain(without).collect();
        Self { development, exposure, reach, full, whole: &effects.picture }
    }

    fn shown(&self, picture: &Picture) -> DisplayImage {
        develop_with_reach(picture, self.exposure, self.reach, &self.development)
    }
}

fn image(screen: &DisplayImage, words: &str) -> Result<Markup> {
    let source = data_uri("image/png", &encode(screen)?);
    Ok(html! { img src=(source) alt=(words) width=(screen.width) height=(screen.height); })
}

/// Writes the page. Returns an error if a picture is too large for PNG.
pub(super) fn page(report: &StudyReport, pictures: &StudyPictures<'_>) -> Result<String> {
    let title = format!("What accuracy costs: {}", report.title);
    let body = html! {
        header {
            h1 { "What accuracy costs" }
            p.lead { (report.title) }
            (summary(report))
        }
        (compared(pictures)?)
        (recommendations(report))
        (curves(report))
        (sweep(report))
        (effects(report, pictures)?)
        (method(report))
        script { (PreEscaped(include_str!("page.js"))) }
    };
    Ok(document(&title, include_str!("page.css"), &body))
}

fn summary(report: &StudyReport) -> Markup {
    let film = &report.film;
    let (error, passes) = report
        .sweep
        .default
        .map_or_else(|| (None, report.curves[0].passes_wanted), |point| (Some(point.error.whole), point.passes));
    html! {
        p {
            @if let Some((point, error)) = report.sweep.default.zip(error) {
                "With the scene's own settings (" (passes) " passes), the error of a typical pixel is " strong { (root(point.error.typical.value)) }
                " (relMSE " (short(error.value)) ") after " strong { (time(point.seconds)) } ". "
            } @else {
                "The study ended before the " (passes) " passes that the scene states. "
            }
            "All times were measured with " (report.machine.words()) ". All errors were measured on pictures of "
            (film.width) " × " (film.height) " pixels"
            @if film.pixel_ratio() > 1.0 { " (the scene's own film has " (film.own_width) " × " (film.own_height) ")" }
            "."
        }
    }
}

fn compared(pictures: &StudyPictures<'_>) -> Result<Markup> {
    let (width, height) = pictures.full.first().map_or((1, 1), |(_, picture)| (picture.width, picture.height));
    let choice = |id: &str, words: &str, chosen: usize| {
        html! {
            label { (words) " "
                select id=(id) {
                    @for (i, (name, _)) in pictures.full.iter().enumerate() {
                        option value=(i) selected[i == chosen] { (name) }
                    }
                }
            }
        }
    };
    let images = pictures.full.iter().map(|(name, picture)| image(&pictures.shown(picture), name));
    let images: Vec<Markup> = images.collect::<Result<_>>()?;
    Ok(html! {
        section id="compare" {
            h2 { "Two pictures" }
            div.choices { (choice("left", "Left", PHOTONS)) (choice("right", "Right", REFERENCE)) }
            div.stage id="stage" style={ "aspect-ratio:" (width) "/" (height) } {
                img id="under" alt="the left picture";
                img.over id="over" alt="the right picture";
                div.handle {}
                input.splitter id="split" type="range" min="0" max="100" step="0.1" value="50" aria-label="where the left picture ends";
            }
            p.soft { "Drag across the picture to compare. All pictures are shown at the automatic exposure of the reference, EV "
                (format!("{:.2}", log2(pictures.exposure))) "." }
            div.pictures hidden { @for image in &images { (image) } }
        }
    })
}

fn recommendations(report: &StudyReport) -> Markup {
    html! {
        section {
            h2 { "Settings and time for a wanted error" }
            @if report.recommendations.is_empty() {
                p { "No measured error exceeded the noise of the reference. A larger time budget is needed." }
            } @else {
                div.table { table.grid {
                    thead { tr {
                        th.number { "error" } th.number { "relMSE" } th.number { "time" } th { "settings" } th.number { "passes" } th { "command" }
                    } }
                    tbody { @for row in &report.recommendations { tr {
                        td.number { strong { (percent(row.typical_error)) } }
                        td.number { (short(row.relative_mse)) }
                        td.number { strong { (time(row.seconds_own_film)) } @if row.extrapolated { " *" } }
                        td { (row.settings) }
                        td.number { (row.passes) }
                        td { code { (row.command) } }
                    } } }
                } }
                p.soft {
                    "The error is the square root of relMSE, the relative mean square error that " code { "abbe compare" } " prints. "
                    "Times hold for the scene's own film size; they were extrapolated from the study's film by the number of pixels."
                    @if report.recommendations.iter().any(|row| row.extrapolated) {
                        " * Extrapolated beyond the last picture with the theoretical slope."
                    }
                }
            }
        }
    }
}

fn curves(report: &StudyReport) -> Markup {
    let in_smooth = report.reference.smooth_fraction.is_some();
    html! {
        section {
            h2 { "Error against time" }
            div.with-plot {
                figure { (PreEscaped(report.curves_graph().svg())) }
                div {
                    div.table { table.grid {
                        thead { tr { th {} th.number { "fitted slope" } th.number { "theory" } } }
                        tbody { @for curve in &report.curves {
                            tr {
                                th scope="row" { (integrator_title(curve.integrator)) ", over passes" }
                                td.number { strong { (slope(curve.fit)) } }
                                td.number { (theory(curve)) }
                            }
                            tr { th.soft scope="row" { "over seconds" } td.number { (slope(curve.fit_seconds)) } td {} }
                            @for theory in &curve.theory {
                                tr { th.soft scope="row" { (theory.estimator) } td {} td.number.soft { (signed(theory.slope)) } }
                            }
                        } }
                    } }
                    p.soft {
                        @if let Some(fraction) = report.reference.smooth_fraction {
                            "Lines and slopes hold for smooth regions (" (percent(fraction)) " of the pixels); dots hold for the whole picture. "
                        } @else {
                            "The picture has too few smooth regions. Lines and slopes hold for the whole picture, where kernels at edges converge more slowly than in theory. "
                        }
                        "Dashed lines show the theoretical slopes from the first point of the fit. Slopes are fitted by least squares to logarithms. The fit uses points with at least 4 passes and an error above three standard errors. ± is the standard error of the fit. "
                        @if in_smooth { "If a picture combines several estimators, the least steep slope dominates after many passes. With fewer passes, the noise of the other estimators dominates. Stratified wavelengths and positions make this noise fall faster than 1/N. " }
                        "Seconds include the pilot."
                    }
                }
            }
            (reference_warning(report))
        }
    }
}

/// Warns if the path tracer cannot find some of the light.
fn reference_warning(report: &StudyReport) -> Markup {
    html! { @if let Some(reason) = &report.reference.unreachable_light {
        p.warning { "The path tracer's error cannot fall to zero here: " (reason) "." }
    } }
}

fn sweep(report: &StudyReport) -> Markup {
    let sweep = &report.sweep;
    html! {
        section {
            h2 { "Settings" }
            div.with-plot {
                figure { (PreEscaped(report.sweep_graph().svg())) }
                div {
                    p { "The Pareto front: no other measured point has a smaller error in less time." }
                    div.table { table.grid {
                        thead { tr { th.number { "time" } th.number { "error" } th.number { "passes" } th { "settings" } } }
                        tbody {
                            @for place in &sweep.front { (place_row(&place.point, &sweep.runs[place.run].settings(), "")) }
                            @if let Some(default) = &sweep.default { (place_row(default, &RenderSettings::DEFAULT, "default")) }
                        }
                    } }
                }
            }
            p.soft {
                "Each run changes one setting. A line shows the error of one run over its passes. "
                @if sweep.default.is_some() { "The ring marks the scene's own settings. " }
                @if !sweep.left_out.is_empty() {
                    "Skipped for lack of time: "
                    (sweep.left_out.iter().map(|change| change.words()).collect::<Vec<_>>().join("; ")) ". "
                }
                "Fixed by design: " (report.fixed_by_design.join("; ")) "."
            }
        }
    }
}

fn place_row(point: &ConvergencePoint, settings: &RenderSettings, class: &str) -> Markup {
    html! { tr class=(class) {
        td.number { (time(point.seconds)) }
        td.number { (root(point.error.typical.value)) }
        td.number { (point.passes) }
        td { (if settings.integrator == Integrator::Path { "path tracer".to_string() } else { settings.words() }) @if class == "default" { " (default)" } }
    } }
}

fn effects(report: &StudyReport, pictures: &StudyPictures<'_>) -> Result<Markup> {
    let effects = &report.effects;
    let mut place = FIRST_EFFECT;
    let whole = shrunk(pictures.whole);
    let mut cards = Vec::new();
    for effect in &effects.on {
        let at = effect.picture.is_some().then_some(place);
        place += usize::from(effect.picture.is_some());
        cards.push(card(effect, effects, (pictures, &whole), at)?);
    }
    Ok(html! {
        section {
            h2 { "Effect by effect" }
            p {
                "Each effect of the scene is left out in turn, for " (passes(effects.passes)) " with the same seed. With all effects, the render takes "
                (time(effects.with.seconds)) " and " (bytes(effects.with.memory_bytes)) ". Noise alone causes ΔE "
                (format!("{:.2}", effects.noise_delta_e_2000.mean)) " and relMSE " (short(effects.noise_relative_mse)) " between two seeds. Pictures of the same seed share most of the noise. Effects that change the use of random numbers (aim, dispersion) do not share this noise."
            }
            div.cards { @for card in &cards { (card) } }
            h3 { "Off in this scene" }
            div.table { table.grid {
                thead { tr { th { "effect" } th.number { "events" } th { "reason" } } }
                tbody { @for off in &effects.off {
                    tr { th scope="row" { (off.name) } td.number { (off.events) } td { @if off.state != "off" { (off.state) "; " } (off.because) } }
                } }
            } }
        }
    })
}

fn card(
    effect: &EffectAblation,
    effects: &EffectStudy,
    (pictures, whole): (&StudyPictures<'_>, &Picture),
    at: Option<usize>,
) -> Result<Markup> {
    let figures = match &effect.left_out {
        AblationResult::Measured { cost, relative_mse, delta_e_2000, error } => {
            measured(effects, cost, (*relative_mse, delta_e_2000), *error)
        }
        AblationResult::Refused(reason) => html! { p.soft { "Cannot be left out: " (reason) "." } },
        AblationResult::NoTime => html! { p.soft { "The study had no time for this effect." } },
    };
    let thumbnails = match &effect.picture {
        Some(picture) => {
            let without = shrunk(picture);
            let difference = colour_differences(&without, whole, &Selection::default(), pictures.exposure);
            let three = [
                (pictures.shown(whole), "with"),
                (pictures.shown(&without), "without"),
                (difference, "ΔE, white at 10"),
            ];
            three.into_iter().map(|(screen, words)| Ok((image(&screen, words)?, words))).collect::<Result<Vec<_>>>()?
        }
        None => Vec::new(),
    };
    Ok(html! {
        article.card {
            h3 { (effect.name) @if effect.state == "forced" { " (forced)" } }
            p.soft { (effect.because) "; " (effect.events) " events" }
            @if !thumbnails.is_empty() {
                div.three { @for (image, words) in &thumbnails { figure { (image) figcaption { (words) } } } }
            }
            (figures)
            @if let Some(at) = at { button type="button" data-left=(PHOTONS) data-right=(at) { "Compare above" } }
        }
    })
}

fn measured(
    effects: &EffectStudy,
    cost: &RenderCost,
    (relative_mse, delta_e): (f64, &DeltaE),
    error: MeanEstimate,
) -> Markup {
    let with = &effects.with;
    let fraction = 1.0 - cost.seconds / with.seconds;
    let change =
        if fraction >= 0.0 { format!("{} less", percent(fraction)) } else { format!("{} more", percent(-fraction)) };
    html! {
        table.figures { tbody {
            tr { th { "time" } td { (time(with.seconds)) " → " (time(cost.seconds)) " (" (change) ")" } }
            tr { th { "memory" } td { (bytes(with.memory_bytes)) " → " (bytes(cost.memory_bytes)) } }
            tr { th { "difference" } td { "ΔE " (format!("{:.2}", delta_e.mean)) ", 95 %: " (format!("{:.1}", delta_e.p95)) "; relMSE " (short(relative_mse)) } }
            tr { th { "RMS error" } td { (root(effects.error.value)) " → " (root(error.value)) } }
        } }
    }
}

fn method(report: &StudyReport) -> Markup {
    let reference = &report.reference;
    let percent_of = |fraction: f64| percent(fraction);
    html! {
        section {
            h2 { "How it was measured" }
            p {
                strong { "Reference: " }
                @match reference.origin {
                    "given" => { (reference.because) ". " }
                    origin => {
                        "by " (integrator_title(origin)) ": " (reference.because) "; two halves with different seeds, " (reference.passes) " passes in "
                        (time(reference.seconds)) ". "
                    }
                }
                "Its own RMS noise is " (root(reference.relative_variance)) " (relMSE " (short(reference.relative_variance))
                "). This noise is subtracted from every error, pixel by pixel. Plots and fits leave out errors below three standard errors. "
                @if reference.origin == "photon" {
                    "Its kernels have a tenth of the area of the scene's kernels, and so about a tenth of the bias. Bias cannot be subtracted; the reference estimates its own bias as "
                    (root(reference.relative_bias_square)) ". "
                }
            }
            p { strong { "Smooth regions: " } (report.smooth_rule) "." }
            p {
                strong { "Time: " } "the renders took " (time(report.spent_seconds)) " of a budget of " (time(report.budget_seconds)) ". The budget is divided as follows: "
                (percent_of(TIME_FRACTIONS.trial)) " trials that choose the integrator of the reference, " (percent_of(TIME_FRACTIONS.reference)) " the reference, "
                (percent_of(TIME_FRACTIONS.photon_curve + TIME_FRACTIONS.path_curve)) " error against time, " (percent_of(TIME_FRACTIONS.sweep)) " the sweep of settings, "
                (percent_of(TIME_FRACTIONS.effects)) " effects. The film is as large as the budget allows, at most 65,536 pixels. The measurement of errors is not counted."
            }
            p { strong { "Memory: " } "film, scene and photons, computed from the number of photons stored in a pass. The operating system reports only the peak of the whole process." }
            p.soft { (report.scene) ", abbe " (report.version) ". The same figures are in study.json and in the CSV files beside this page." }
        }
    }
}

/// Averages square blocks of pixels, to a picture at most [`THUMBNAIL`] pixels wide.
fn shrunk(picture: &Picture) -> Picture {
    let step = picture.width.div_ceil(THUMBNAIL);
    let (width, height) = ((picture.width / step).max(1), (picture.height / step).max(1));
    let mut small = Picture::black(width, height);
    for (i, xyz) in small.xyz.iter_mut().enumerate() {
        let (left, top) = (i % width * step, i / width * step);
        let square = (top..(top + step).min(picture.height)).flat_map(|y| (left..left + step).map(move |x| (x, y)));
        let inside: Vec<usize> =
            square.filter(|(x, _)| *x < picture.width).map(|(x, y)| y * picture.width + x).collect();
        *xyz = [0, 1, 2].map(|c| inside.iter().map(|&i| picture.xyz[i][c]).sum::<f64>() / inside.len() as f64);
    }
    small
}

fn slope(fit: Option<super::fit::PowerLawFit>) -> String {
    fit.map_or("too few points".to_string(), |fit| fit.words())
}

/// Writes the square root of a relative mean square error in percent.
fn root(relative_mse: f64) -> String {
    if relative_mse.is_nan() { "unknown".to_string() } else { percent(relative_mse.max(0.0).sqrt()) }
}

fn percent(fraction: f64) -> String {
    let percent = 100.0 * fraction;
    if percent < 9.95 { format!("{percent:.1} %") } else { format!("{percent:.0} %") }
}

/// Writes a relative mean square error with two digits.
fn short(relative_mse: f64) -> String {
    if !relative_mse.is_finite() {
        return "unknown".to_string();
    }
    let exponent = if relative_mse > 0.0 { log10(relative_mse).floor() as i32 } else { 0 };
    let unit = 10.0_f64.powi(exponent - 1);
    let digits = (relative_mse / unit).round();
    if exponent >= -3 {
        format!("{}", (digits * unit * 1e6).round() / 1e6)
    } else {
        format!("{}·{}", digits / 10.0, power_of_ten(exponent))
    }
}

fn passes(count: u64) -> String {
    format!("{count} pass{}", if count == 1 { "" } else { "es" })
}

fn time(seconds: f64) -> String {
    match seconds {
        s if s < 0.995 => format!("{:.0} ms", 1000.0 * s),
        s if s < 9.95 => format!("{s:.1} s"),
        s if s < 99.5 => format!("{s:.0} s"),
        s if s < 5940.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

fn bytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 * 1e-6)
}
