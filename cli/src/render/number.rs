//! Numbers, times and bytes as people read them. Nothing here is read back by a program.

/// A fitness or a measure: four decimals where they say something, else scientific.
pub(crate) fn figure(value: f64) -> String {
    match value.abs() {
        size if value == 0.0 || (1e-3..1e7).contains(&size) => format!("{value:.4}"),
        _ if value.is_finite() => format!("{value:.4e}"),
        _ => value.to_string(),
    }
}

/// A figure that may be absent.
pub(crate) fn figure_or_dash(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), figure)
}

/// A count with its digits in groups of three.
pub(crate) fn count(value: u64) -> String {
    let digits = value.to_string();
    let mut grouped = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}

/// A stretch of time in its two largest units.
pub(crate) fn stretch(seconds: f64) -> String {
    let whole = seconds.max(0.0) as u64;
    match whole {
        0..60 => format!("{seconds:.1} s"),
        60..3600 => format!("{} min {} s", whole / 60, whole % 60),
        3600..86_400 => format!("{} h {} min", whole / 3600, whole % 3600 / 60),
        _ => format!("{} d {} h", whole / 86_400, whole % 86_400 / 3600),
    }
}

/// Unix time in ms as a UTC time to the second. Days to a civil date after Hinnant, "chrono-compatible
/// low-level date algorithms": eras of 400 years that begin in March.
pub(crate) fn time(unix_ms: i64) -> String {
    let seconds = unix_ms.div_euclid(1000);
    let (days, second) = (seconds.div_euclid(86_400), seconds.rem_euclid(86_400));
    let shifted = days + 719_468;
    let era = shifted.div_euclid(146_097);
    let day_of_era = shifted.rem_euclid(146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    let year = year_of_era + era * 400 + i64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02} {:02}:{:02}:{:02}", second / 3600, second / 60 % 60, second % 60)
}

/// Bytes in hexadecimal.
pub(crate) fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The exact bits of a number.
pub(crate) fn bits(value: f64) -> String {
    format!("0x{:016x}", value.to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_keep_what_says_something() {
        assert_eq!(figure(80.854_32), "80.8543");
        assert_eq!(figure(0.0), "0.0000");
        assert_eq!(figure(-2.5e-7), "-2.5000e-7");
        assert_eq!(figure_or_dash(None), "-");
    }

    #[test]
    fn counts_and_stretches_are_grouped() {
        assert_eq!(
            (count(7), count(1234), count(3_840_000)),
            ("7".into(), "1,234".into(), "3,840,000".into())
        );
        assert_eq!(stretch(59.94), "59.9 s");
        assert_eq!(stretch(3725.0), "1 h 2 min");
        assert_eq!(stretch(200_000.0), "2 d 7 h");
    }

    #[test]
    fn times_are_civil_also_on_leap_days_and_before_1970() {
        assert_eq!(time(0), "1970-01-01 00:00:00");
        assert_eq!(time(951_782_400_000), "2000-02-29 00:00:00");
        assert_eq!(time(1_735_689_599_999), "2024-12-31 23:59:59");
        assert_eq!(time(-1000), "1969-12-31 23:59:59");
    }

    #[test]
    fn bits_tell_what_digits_may_not() {
        assert_eq!(bits(1.0), "0x3ff0000000000000");
        assert_ne!(bits(0.0), bits(-0.0));
        assert_eq!(hex(&[0, 255]), "00ff");
    }
}
