//! Light and warmth of the water, which decide where a fish feels at home. They do nothing to a body.

use super::obstacle::slab;
use crate::SpecError;
use crate::math::exp;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The fields of light and temperature.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Climate {
    /// T_s, temperature at z = 0.
    pub temperature: f64,
    /// g, temperature gained by each length unit of height.
    pub gradient: f64,
    /// Warm and cold places.
    pub blobs: Vec<Blob>,
    /// I₀, light at the surface.
    pub light: f64,
    /// k, how fast light fails with depth.
    pub absorption: f64,
    /// Dark places.
    pub shades: Vec<Shade>,
}

/// A warm or cold place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Blob {
    /// Where it is strongest.
    pub center: [f64; 3],
    /// Standard deviation, length units.
    pub width: f64,
    /// Temperature added at its centre.
    pub excess: f64,
}

/// A dark place: a box.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shade {
    /// Its middle.
    pub center: [f64; 3],
    /// From the middle to its faces.
    pub half: [f64; 3],
    /// The share of light that is left in it.
    pub share: f64,
}

impl Default for Climate {
    fn default() -> Self {
        Climate {
            temperature: 20.0,
            gradient: 0.02,
            blobs: Vec::new(),
            light: 1.0,
            absorption: 0.005,
            shades: Vec::new(),
        }
    }
}

impl Climate {
    /// T_s + g z plus the blobs.
    pub fn temperature(&self, at: DVec3) -> f64 {
        let blob = |blob: &Blob| {
            let way = (at - DVec3::from_array(blob.center)) / blob.width;
            blob.excess * exp(-0.5 * way.length_squared())
        };
        self.blobs.iter().fold(self.temperature + self.gradient * at.z, |sum, one| sum + blob(one))
    }

    /// I₀ exp(−k depth), times the share of every shade that lies there; `surface` is the water's height.
    pub fn light(&self, at: DVec3, surface: f64) -> f64 {
        let open = self.light * exp(-self.absorption * (surface - at.z).max(0.0));
        let inside = |shade: &&Shade| {
            slab(at, DVec3::from_array(shade.center), DVec3::from_array(shade.half)).max_element() <= 0.0
        };
        self.shades.iter().filter(inside).fold(open, |light, shade| light * shade.share)
    }

    /// # Errors
    /// The key that is out of range and what is allowed.
    pub fn check(&self) -> Result<(), SpecError> {
        for (key, value, most) in [
            ("temperature", self.temperature.abs(), 100.0),
            ("gradient", self.gradient.abs(), 10.0),
            ("light", self.light, 10.0),
            ("absorption", self.absorption, 10.0),
        ] {
            if !(0.0..=most).contains(&value) {
                return Err(SpecError::new(key, format!("is not within its bound of {most}")));
            }
        }
        for (index, blob) in self.blobs.iter().enumerate() {
            if !(blob.width > 0.0 && blob.width.is_finite() && blob.excess.is_finite()) {
                return Err(SpecError::new(format!("blobs[{index}]"), "needs a width above 0"));
            }
        }
        for (index, shade) in self.shades.iter().enumerate() {
            if !(0.0..=1.0).contains(&shade.share) {
                return Err(SpecError::new(format!("shades[{index}].share"), "is not within 0 to 1"));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    ///
    #[test]
    fn light_fails_with_depth_and_in_the_shade() {
        let mut climate = Climate::default();
        assert_eq!(climate.light(DVec3::new(0.0, 0.0, 100.0), 100.0), 1.0);
        let deep = climate.light(DVec3::ZERO, 100.0);
        assert!((deep - 0.6065306597126334).abs() < 1e-12, "{deep}");
        climate.shades.push(Shade { center: [0.0; 3], half: [1.0; 3], share: 0.5 });
        assert_eq!(climate.light(DVec3::ZERO, 100.0), 0.5 * deep);
        assert_eq!(climate.light(DVec3::new(1.1, 0.0, 0.0), 100.0), deep);
    }

    #[test]
    fn warmth_rises_with_height_and_toward_blobs() {
        let blobs = vec![Blob { center: [10.0, 0.0, 0.0], width: 5.0, excess: 4.0 }];
        let climate = Climate { blobs, ..Climate::default() };
        assert_eq!(climate.temperature(DVec3::new(10.0, 0.0, 0.0)), 24.0);
        let beside = climate.temperature(DVec3::new(5.0, 0.0, 50.0));
        assert!((beside - 21.0 - 4.0 * exp(-50.5)).abs() < 1e-12, "{beside}");
    }
}
