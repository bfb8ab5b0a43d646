//! Sun and sky of a clear day, and where the sun stands at a time and place.

use straal_math::{DVec3, ops};

use crate::desc::check;
use crate::desc::lamp::Lamp;
use crate::desc::light::Portal;
use crate::desc::spectrum::Spectrum;
use crate::desc::transform::Transform;
use crate::describe::describe;
use crate::limit::Limit;
use crate::value::Name;

describe! {
    /// Sun and sky of a clear day, as measured air scatters light (Hosek and Wilkie 2012 and 2013). Up is local +y; nothing shines from below the horizon.
    ///
    /// Its numbers are physical ones, for each nanometre of wavelength: W/(m^2 sr nm), and for the sun W/(m^2 nm), which is about 1 at noon.
    pub struct Sky [check::sky] {
        /// Towards the sun; give this or `when`.
        sun_direction: Option<DVec3> = None,
        /// Date, time and place, from which follows where the sun stands; give this or `sun_direction`.
        when: Option<When> = None,
        /// How hazy the air is: 2 very clear, 3 clear, 6 warm and moist, 10 slightly foggy.
        turbidity: f64 [Limit::within(1.0, 10.0)] = 3.0,
        /// The share of light that the ground sends back up, which brightens the sky.
        ground_albedo: Spectrum [Limit::UNIT] = Spectrum::grey(0.3),
        /// What the sky's radiance is multiplied by; 0 leaves the sun alone.
        sky_scale: f64 [Limit::NON_NEGATIVE] = 1.0,
        /// What the sun's irradiance is multiplied by; 0 leaves the sky alone.
        sun_scale: f64 [Limit::NON_NEGATIVE] = 1.0,
        /// Irradiance that the sun brings to a surface that faces it, before `sun_scale`; by the model when absent.
        sun_irradiance: Option<Spectrum> [Limit::NON_NEGATIVE] = None,
        /// What the sun takes of the sky from rim to rim, in degrees; its irradiance stays the same.
        sun_angle: f64 [Limit::within(0.01, 90.0)] = 0.5358,
        /// Whether the sun is darker towards its rim, as it is.
        limb_darkening: bool = false,
        /// Openings through which the sky's light comes into a room: windows, whose light is found with less noise. Light that comes in elsewhere is then found by BSDF sampling alone.
        portals: Vec<Portal> = Vec::new(),
        /// Turn about the local y axis in degrees, counter-clockwise seen from above, before `transform`; the sun turns with it.
        rotate: f64 = 0.0,
        /// Where its axes lie; only its rotation counts.
        transform: Transform = Transform::default(),
        /// What `zones`, and groups of lamps by their names, call it.
        name: Option<Name> = None,
    } with lamp: Lamp
}

describe! {
    /// A time and a place on Earth. North is along local -z, east along +x.
    pub struct When [check::when] {
        /// Degrees north of the equator; south of it below 0.
        latitude: f64 [Limit::within(-90.0, 90.0)],
        /// Degrees east of Greenwich; west of it below 0.
        longitude: f64 [Limit::within(-180.0, 180.0)],
        /// Year, month and day.
        date: [u32; 3],
        /// Time of the day in hours, as clocks there show it: 14.5 is half past two.
        hour: f64 [Limit::within(0.0, 24.0)] = 12.0,
        /// Hours that clocks there are ahead of Universal Time.
        utc_offset: f64 [Limit::within(-14.0, 14.0)] = 0.0,
    }
}

impl Sky {
    /// Towards the sun in the sky's own axes, of unit length; straight up where nothing says it.
    pub fn towards_sun(&self) -> DVec3 {
        let said = self.sun_direction.and_then(DVec3::try_normalize);
        said.or_else(|| self.when.as_ref().map(When::towards_sun)).unwrap_or(DVec3::Y)
    }
}

impl When {
    /// Whether there is such a date.
    pub fn is_sound(&self) -> bool {
        let [year, month, day] = self.date;
        let leap = year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
        let days = match month {
            4 | 6 | 9 | 11 => 30,
            2 => 28 + u32::from(leap),
            _ => 31,
        };
        (1..=9999).contains(&year) && (1..=12).contains(&month) && (1..=days).contains(&day)
    }

    /// Days since noon of 1 January 2000, Universal Time.
    fn days(&self) -> f64 {
        let [year, month, day] = self.date.map(f64::from);
        // From March on, so that a leap day is the last of its year (Fliegel and Van Flandern 1968).
        let (y, m) = if month > 2.0 { (year, month - 3.0) } else { (year - 1.0, month + 9.0) };
        let leaps = (y / 4.0).floor() - (y / 100.0).floor() + (y / 400.0).floor();
        let whole = 365.0 * y + leaps + ((153.0 * m + 2.0) / 5.0).floor() + day - 730_426.0;
        whole - 0.5 + (self.hour - self.utc_offset) / 24.0
    }

    /// Towards the sun, of unit length: by the almanac of Blanco-Muriel, Alarcón-Padilla, López-Moratalla and Lara-Coira (2001, "Computing the Solar
    /// Vector"), which is right to a hundredth of a degree in these decades.
    pub fn towards_sun(&self) -> DVec3 {
        let n = self.days();
        let degrees = |radians: f64| radians.to_degrees();
        let sin_cos = |radians: f64| ops::sin_cos_degrees(degrees(radians));
        // Ecliptic coordinates: mean longitude and anomaly, ecliptic longitude, obliquity.
        let omega = 2.1429 - 0.001_039_459_4 * n;
        let mean = 4.895_063_0 + 0.017_202_791_698 * n;
        let anomaly = 6.240_060_0 + 0.017_201_969_9 * n;
        let longitude = mean + 0.033_416_07 * sin_cos(anomaly).0 + 0.000_348_94 * sin_cos(2.0 * anomaly).0
            - 0.000_113_4
            - 0.000_020_3 * sin_cos(omega).0;
        let obliquity = 0.409_092_8 - 6.214_0e-9 * n + 0.000_039_6 * sin_cos(omega).1;
        // Celestial coordinates.
        let ((sin_l, cos_l), (sin_e, cos_e)) = (sin_cos(longitude), sin_cos(obliquity));
        let ascension = ops::atan2_d(cos_e * sin_l, cos_l);
        let sin_d = sin_e * sin_l;
        let cos_d = (1.0 - sin_d * sin_d).sqrt();
        // As seen from here: by the angle that the Earth has turned on since the sun stood in the south.
        let turned = 6.697_424_324_2 + 0.065_709_828_3 * n + (self.hour - self.utc_offset);
        let (sin_h, cos_h) = ops::sin_cos_degrees(turned * 15.0 + self.longitude - degrees(ascension));
        let (sin_b, cos_b) = ops::sin_cos_degrees(self.latitude);
        let up = cos_b * cos_h * cos_d + sin_d * sin_b;
        let (east, north) = (-sin_h * cos_d, sin_d * cos_b - cos_d * sin_b * cos_h);
        // We stand on the Earth's surface, not in its middle.
        const PARALLAX: f64 = 6371.01 / 149_597_890.0;
        DVec3::new(east, up - PARALLAX, -north).try_normalize().unwrap_or(DVec3::Y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angles(latitude: f64, longitude: f64, date: [u32; 3], (hour, utc_offset): (f64, f64)) -> [f64; 2] {
        let d = When { latitude, longitude, date, hour, utc_offset }.towards_sun();
        let level = (d.x * d.x + d.z * d.z).sqrt();
        [ops::atan2_d(d.y, level).to_degrees(), ops::atan2_d(d.x, -d.z).to_degrees().rem_euclid(360.0)]
    }

    /// Elevation and azimuth east of north, against almanacs.
    #[test]
    fn the_sun_stands_where_almanacs_have_it() {
        for (place, date, time, [elevation, azimuth]) in [
            // The worked example of the solar position algorithm of NREL (Reda and Andreas 2003, table A5.1): zenith angle 50.111 degrees.
            ([39.742_476, -105.1786], [2003, 10, 17], (12.508_333, -7.0), [39.888, 194.34]),
            // Noon at the equator at an equinox: overhead but for the equation of time, 7.5 minutes.
            ([0.0, 0.0], [2020, 3, 20], (12.125, 0.0), [89.8, f64::NAN]),
            // Midsummer noon at 52 degrees north: 90 - 52 + 23.44.
            ([52.0, 0.0], [2024, 6, 20], (12.03, 0.0), [61.43, 180.0]),
            // Midwinter there.
            ([52.0, 0.0], [2024, 12, 21], (11.97, 0.0), [14.56, 180.0]),
            // In the south the noon sun stands in the north.
            ([-35.0, 0.0], [2024, 12, 21], (11.97, 0.0), [78.4, 0.0]),
        ] {
            let [up, around] = angles(place[0], place[1], date, time);
            assert!((up - elevation).abs() < 0.3, "{date:?}: {up}, expected {elevation}");
            let off = (around - azimuth + 540.0).rem_euclid(360.0) - 180.0;
            assert!(azimuth.is_nan() || off.abs() < 1.0, "{date:?}: {around}, expected {azimuth}");
        }
        let [up, around] = angles(39.742_476, -105.1786, [2003, 10, 17], (12.508_333, -7.0));
        assert!((up - 39.888).abs() < 0.02 && (around - 194.34).abs() < 0.02, "{up}, {around}");
    }

    #[test]
    fn dates_that_never_were_are_not_sound() {
        let sound =
            |date| When { latitude: 0.0, longitude: 0.0, date, hour: 12.0, utc_offset: 0.0 }.is_sound();
        assert!(sound([2024, 2, 29]) && sound([2000, 2, 29]) && sound([1999, 12, 31]));
        for date in [
            [2023, 2, 29],
            [1900, 2, 29],
            [2024, 4, 31],
            [2024, 13, 1],
            [2024, 0, 1],
            [2024, 1, 0],
            [0, 1, 1],
        ] {
            assert!(!sound(date), "{date:?}");
        }
    }
}
