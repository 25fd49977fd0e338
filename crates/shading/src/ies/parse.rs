//! The text of an LM-63 file.

use super::{IesProfile, Symmetry};

/// Angles this close (degrees) are the same.
const SAME_DEG: f32 = 1e-3;
/// No table is larger: a wrong number must not ask for the machine's memory.
const MOST_VALUES: usize = 1 << 24;
/// Candela above this are cut: products with it stay finite in single precision.
const BRIGHTEST: f64 = 1e30;

/// Numbers after the header, one after the other.
struct Numbers<'t>(Box<dyn Iterator<Item = &'t str> + 't>);

impl<'t> Numbers<'t> {
    fn new(text: &'t str) -> Self {
        let tokens = text.split(|c: char| c.is_whitespace() || c == ',' || c == '\u{1a}' || c == '\0');
        Self(Box::new(tokens.filter(|t| !t.is_empty())))
    }
    fn next(&mut self, what: &str) -> Result<f64, String> {
        let token = self.0.next().ok_or_else(|| format!("it ends before {what}"))?;
        let value: f64 = token.parse().map_err(|_| format!("{what}: '{token}' is not a number"))?;
        if value.is_finite() { Ok(value) } else { Err(format!("{what}: '{token}' is not a finite number")) }
    }
    fn count(&mut self, what: &str) -> Result<usize, String> {
        let value = self.next(what)?;
        if value >= 0.0 && value.fract() == 0.0 && value <= MOST_VALUES as f64 {
            Ok(value as usize)
        } else {
            Err(format!("{what}: {value} is no sensible number"))
        }
    }
    fn many(&mut self, count: usize, what: &str) -> Result<Vec<f64>, String> {
        (0..count).map(|_| self.next(what)).collect()
    }
    fn skip(&mut self, count: usize, what: &str) -> Result<(), String> {
        (0..count).try_for_each(|_| self.next(what).map(|_| ()))
    }
}

/// The line `TILT=…`: what it says, and what follows it.
fn tilt(text: &str) -> Option<(&str, &str)> {
    let mut rest = text.trim_start_matches('\u{feff}');
    while !rest.is_empty() {
        let (line, after) = rest.split_once(['\n', '\r']).unwrap_or((rest, ""));
        let line = line.trim();
        if let Some(head) = line.get(..5)
            && head.eq_ignore_ascii_case("TILT=")
        {
            return Some((line[5..].trim(), after));
        }
        rest = after;
    }
    None
}

/// A profile, or what is wrong with the text.
pub(super) fn parse(text: &str) -> Result<IesProfile, String> {
    let (tilt, body) = tilt(text).ok_or("it has no line that begins with TILT=")?;
    let mut numbers = Numbers::new(body);
    if tilt.eq_ignore_ascii_case("INCLUDE") {
        // Lamp output by the tilt of the luminaire, which no light of USD has.
        numbers.next("the lamp's geometry")?;
        let pairs = numbers.count("the number of tilt angles")?;
        numbers.skip(2 * pairs, "a tilt angle or factor")?;
    }
    numbers.next("the number of lamps")?;
    numbers.next("the lumens per lamp")?;
    let multiplier = numbers.next("the candela multiplier")?;
    let n_vertical = numbers.count("the number of vertical angles")?;
    let n_horizontal = numbers.count("the number of horizontal angles")?;
    let photometry = numbers.count("the photometric type")?;
    numbers.skip(4, "the units and size of the luminaire")?;
    let ballast = numbers.next("the ballast factor")?;
    let ballast_lamp = numbers.next("the ballast-lamp photometric factor")?;
    numbers.next("the input watts")?;
    match photometry {
        1 => {}
        2 => return Err("its photometry is of type B; only type C is read".into()),
        3 => return Err("its photometry is of type A; only type C is read".into()),
        other => return Err(format!("there is no photometric type {other}")),
    }
    if n_vertical < 2 || n_horizontal < 1 || n_vertical.saturating_mul(n_horizontal) > MOST_VALUES {
        return Err(format!("{n_vertical} vertical and {n_horizontal} horizontal angles make no profile"));
    }
    let vertical = numbers.many(n_vertical, "a vertical angle")?;
    let horizontal = numbers.many(n_horizontal, "a horizontal angle")?;
    // In 2019 the second factor became the kind of file.
    let is_2019 = text.trim_start_matches('\u{feff}').trim_start().starts_with("IES:LM-63-2019");
    let factor = multiplier * ballast * if is_2019 { 1.0 } else { ballast_lamp };
    let candela = numbers.many(n_vertical * n_horizontal, "a candela value")?;
    let candela = candela.iter().map(|c| (c * factor).clamp(0.0, BRIGHTEST) as f32).collect();
    profile(&vertical, &horizontal, candela)
}

fn profile(vertical: &[f64], horizontal: &[f64], candela: Vec<f32>) -> Result<IesProfile, String> {
    let ascending = |angles: &[f64]| angles.windows(2).all(|w| w[0] < w[1]);
    if !ascending(vertical) || !ascending(horizontal) {
        return Err("its angles do not ascend".into());
    }
    let (first, last) = (vertical[0], vertical[vertical.len() - 1]);
    let same = |a: f64, b: f64| (a - b).abs() < f64::from(SAME_DEG);
    if first < -f64::from(SAME_DEG) || last > 180.0 + f64::from(SAME_DEG) {
        return Err(format!("vertical angles from {first}° to {last}° are not those of type C"));
    }
    let (first, last) = (horizontal[0], horizontal[horizontal.len() - 1]);
    let symmetry = if horizontal.len() == 1 {
        Symmetry::Axial
    } else if same(first, 0.0) && same(last, 90.0) {
        Symmetry::Quadrants
    } else if same(first, 0.0) && same(last, 180.0) {
        Symmetry::AboutZero
    } else if same(first, 90.0) && same(last, 270.0) {
        Symmetry::AboutNinety
    } else if same(first, 0.0) && last > 180.0 && last < 360.0 + f64::from(SAME_DEG) {
        // Some files leave the plane of 360° out.
        Symmetry::None
    } else {
        return Err(format!("horizontal angles from {first}° to {last}° are not those of type C"));
    };
    let radians = |angles: &[f64], most: f64| angles.iter().map(|a| a.clamp(0.0, most).to_radians() as f32).collect();
    let (vertical, horizontal) = (radians(vertical, 180.0), radians(horizontal, 360.0));
    let mut profile = IesProfile { vertical, horizontal, candela, symmetry, mean: 0.0 };
    profile.mean = profile.integrated_mean() as f32;
    Ok(profile)
}
