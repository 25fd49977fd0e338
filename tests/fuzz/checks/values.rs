//! Numbers that break things, beside plain ones that make hits likely.

use arbitrary::{Arbitrary, Result, Unstructured};
use umber_math::{Point3, Vec3};

/// Numbers at the ends of what floats can do, and where arithmetic on them rounds, overflows or underflows.
const SPECIAL: [f32; 32] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN,
    1.7e38,
    -1.8e38,
    1e30,
    -1e30,
    1e20,
    -1.8446743e19,
    1e12,
    16777217.0,
    -16777215.0,
    1e5,
    1.0 + f32::EPSILON,
    1.0 - f32::EPSILON / 2.0,
    0.1,
    -1.0 / 3.0,
    f32::EPSILON,
    -1e-6,
    1e-12,
    -1e-19,
    1e-20,
    1e-30,
    -1e-35,
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    1e-40,
    -1e-45,
    1e-45,
    -0.0,
];

/// Any float. Most bytes stand for a sixteenth between −4 and 4, so that vertices coincide and rays hit.
#[derive(Clone, Copy, Debug)]
pub struct Value(pub f32);

impl<'a> Arbitrary<'a> for Value {
    fn arbitrary(u: &mut Unstructured<'a>) -> Result<Self> {
        let sixteenths = |b: u8| (f32::from(b) - 64.0) / 16.0;
        let kind = u8::arbitrary(u)?;
        Ok(Self(match kind {
            0..128 => sixteenths(kind),
            128..160 => SPECIAL[usize::from(kind - 128)],
            160..192 => sixteenths(u8::arbitrary(u)? & 127) * f32::from(i8::arbitrary(u)?).exp2(),
            192..224 => f32::from(i16::arbitrary(u)?) / 32768.0,
            224.. => f32::from_bits(u32::arbitrary(u)?),
        }))
    }
}

/// Any three floats.
#[derive(Arbitrary, Clone, Copy, Debug)]
pub struct Triple([Value; 3]);

impl Triple {
    pub fn vector(self) -> Vec3 {
        Vec3::from(self.0.map(|v| v.0))
    }
    pub fn point(self) -> Point3 {
        Point3(self.vector())
    }
}

/// A share from 0 to 1.
#[derive(Arbitrary, Clone, Copy, Debug)]
pub struct Share(u8);

impl Share {
    pub fn get(self) -> f32 {
        f32::from(self.0) / 255.0
    }
}

/// Any double: mostly a float, now and then one out of the range of floats.
#[derive(Clone, Copy, Debug)]
pub struct Double(pub f64);

impl<'a> Arbitrary<'a> for Double {
    fn arbitrary(u: &mut Unstructured<'a>) -> Result<Self> {
        let plain = u8::arbitrary(u)? < 240;
        let value = f64::from(Value::arbitrary(u)?.0);
        Ok(Self(if plain { value } else { value * (8.0 * f64::from(i8::arbitrary(u)?)).exp2() }))
    }
}
