//! Portals: openings that guide the sampling of a dome light.
//!
//! A portal changes nothing that is seen. Of the directions that are sampled to the dome a part goes through the portals
//! that the point is behind, the others go where they would without; the density is that of the mixture, so that the
//! mean stays whatever the portals are, also where they leave an opening out or stand in the way.

use glam::Vec2;
use umber_math::{DAffine3, Point3, Vector3};

use super::params::{LightKind, LightParams, LightProblem};
use super::{DomeLight, Light, LightSample, RectLight};

/// How much of a dome's directions are sampled without regard to portals, where its light is the same from everywhere:
/// little, but never nothing.
const PLAIN_SHARE: f32 = 0.1;
/// As above, where a picture has bright spots that a portal knows nothing of.
const PICTURE_SHARE: f32 = 0.5;

/// An opening (`UsdLuxPortalLight`): a rectangle in the XY plane around the origin of its space, through which light
/// goes along −Z.
#[derive(Clone, Debug)]
pub struct Portal(RectLight);

impl Portal {
    /// From its place in render space and its sizes along X and Y.
    ///
    /// # Errors
    /// Where nothing is left of it: a singular transform, no area.
    pub fn new(render_from_portal: DAffine3, width: f32, height: f32) -> Result<Self, LightProblem> {
        if !render_from_portal.is_finite() {
            return Err(LightProblem::SingularTransform);
        }
        let params = LightParams {
            render_from_light: render_from_portal,
            ..LightParams::new(LightKind::Rect { width, height })
        };
        // its light is white and whole: nothing of it can need mending
        RectLight::new(&params, width, height, &mut Vec::new()).map(Self)
    }
}

/// The portals of one dome, at least one.
#[derive(Clone, Debug)]
pub(crate) struct Portals {
    portals: Vec<RectLight>,
    /// How much of the directions the dome samples itself.
    dome_share: f32,
}

impl Light {
    /// The same light, sampled through these portals if it is a dome with shadows. One that shines through
    /// everything comes through no opening.
    #[must_use]
    pub fn with_portals(mut self, portals: Vec<Portal>) -> Self {
        if let Self::Dome(dome) = &mut self
            && dome.emission.shadow_enable
            && !portals.is_empty()
        {
            let dome_share = if dome.has_texture() { PICTURE_SHARE } else { PLAIN_SHARE };
            let portals = portals.into_iter().map(|p| p.0).collect();
            dome.portals = Some(Box::new(Portals { portals, dome_share }));
        }
        self
    }
}

impl Portals {
    /// How large all of them look from a point, about; `None` where it is behind none.
    #[inline]
    fn total(&self, p: Point3) -> Option<f32> {
        let total: f32 = self.portals.iter().map(|portal| portal.apparent_size(p)).sum();
        (total > 0.0 && total.is_finite()).then_some(total)
    }

    /// A direction to the dome.
    #[inline]
    pub(crate) fn sample(&self, dome: &DomeLight, p: Point3, u: Vec2) -> Option<LightSample> {
        let Some(total) = self.total(p) else { return dome.sample_all(u) };
        let (share, rest) = (self.dome_share, 1.0 - self.dome_share);
        if u.x < share {
            let sample = dome.sample_all(Vec2::new(u.x / share, u.y))?;
            let pdf_portals = self.pdf_through(p, sample.wi, total, None);
            return Some(LightSample {
                pdf_solid_angle: share * sample.pdf_solid_angle + rest * pdf_portals,
                ..sample
            });
        }
        let mut left = (u.x - share) / rest * total;
        let mut chosen = None;
        for (index, portal) in self.portals.iter().enumerate() {
            let size = portal.apparent_size(p);
            if size > 0.0 {
                let within = (left / size).clamp(0.0, 1.0 - 0.5 * f32::EPSILON);
                chosen = Some((index, portal, size, within));
                if left < size {
                    break;
                }
                left -= size;
            }
        }
        let (index, portal, size, within) = chosen?;
        let through = portal.sample(p, Vec2::new(within, u.y))?;
        // the rounded direction may just miss its own portal: the density is known without asking
        let pdf_portals = size / total * through.pdf_solid_angle + self.pdf_through(p, through.wi, total, Some(index));
        let place = dome.place_of(through.wi);
        let pdf_solid_angle = share * dome.pdf_all_at(place) + rest * pdf_portals;
        let radiance = dome.radiance_at(place);
        Some(LightSample { radiance, pdf_solid_angle, distance: f32::INFINITY, ..through })
    }

    /// Density with which [`Portals::sample`] makes a direction that the dome makes with density `pdf_dome`.
    #[inline]
    pub(crate) fn pdf_solid_angle(&self, pdf_dome: f32, p: Point3, wi: Vector3) -> f32 {
        let Some(total) = self.total(p) else { return pdf_dome };
        self.dome_share * pdf_dome + (1.0 - self.dome_share) * self.pdf_through(p, wi, total, None)
    }

    /// Density of a direction through the portals, one of them left out.
    #[inline]
    fn pdf_through(&self, p: Point3, wi: Vector3, total: f32, but: Option<usize>) -> f32 {
        let density = |(index, portal): (usize, &RectLight)| {
            if but == Some(index) { 0.0 } else { portal.apparent_size(p) / total * portal.pdf_solid_angle(p, wi) }
        };
        self.portals.iter().enumerate().map(density).sum()
    }
}
