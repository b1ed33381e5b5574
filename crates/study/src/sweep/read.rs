//! The table of a sweep, read back.

use super::case::Figures;
use kinstep_files::trajectory::csv_records::Records;

/// The columns before and after those of what varies, in a table of comma-separated values.
const BEFORE: [&str; 3] = ["case", "status", "scenario"];
const VARIED: &str = "varied.";

/// The table of a sweep: what varied, and what came of every case.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepTable {
    /// The keys that varied.
    pub keys: Vec<String>,
    /// The cases, in their order.
    pub rows: Vec<SweepRow>,
}

/// One case of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepRow {
    /// The scenario.
    pub scenario: String,
    /// How the run ended, or `refused`.
    pub status: String,
    /// The value of every key, as it was laid over the scenario.
    pub values: Vec<String>,
    /// The figures of the run by their columns; NaN where there are none.
    numbers: [f64; Figures::NAMES.len()],
}

impl SweepRow {
    /// Returns a figure of the run by the name of its column, such as `max_error`; NaN where there is none.
    pub fn figure(&self, name: &str) -> f64 {
        Figures::NAMES.iter().position(|known| *known == name).map_or(f64::NAN, |place| self.numbers[place])
    }

    /// Whether the run came to its end.
    pub fn is_completed(&self) -> bool {
        self.status == "completed"
    }
}

impl SweepTable {
    /// Reads a table as `kinstep sweep` writes it: comma-separated values or, in a program with the command line, JSON.
    ///
    /// # Errors
    /// A sentence that says why the text is no such table.
    pub fn parse(text: &str) -> Result<Self, String> {
        if text.trim_start().starts_with('[') {
            return Self::from_json(text);
        }
        Self::from_csv(text)
    }

    fn from_csv(text: &str) -> Result<Self, String> {
        let mut records = Records::new(text);
        let mut fields = Vec::new();
        let mut next = || -> Result<Option<Vec<String>>, String> {
            let found = records.read(&mut fields).map_err(|problem| problem.message)?;
            Ok(found.then(|| fields.iter().map(|field| field.text.to_string()).collect()))
        };
        let heading = next()?.unwrap_or_default();
        if heading.len() < BEFORE.len() || heading[..BEFORE.len()] != BEFORE {
            return Err(format!("its first line does not begin with {}", BEFORE.join(",")));
        }
        let place = |name: &str| heading.iter().position(|column| column == name);
        let keys: Vec<String> =
            heading.iter().filter_map(|column| column.strip_prefix(VARIED)).map(str::to_owned).collect();
        let columns = Figures::NAMES.map(place);
        let mut rows = Vec::new();
        while let Some(cells) = next()? {
            if cells.len() != heading.len() {
                let (row, have, want) = (rows.len() + 1, cells.len(), heading.len());
                return Err(format!("case {row} has {have} cells and the heading {want}"));
            }
            let number = |column: Option<usize>| {
                column.and_then(|column| cells[column].parse().ok()).unwrap_or(f64::NAN)
            };
            rows.push(SweepRow {
                status: cells[1].clone(),
                scenario: cells[2].clone(),
                values: cells[BEFORE.len()..].iter().take(keys.len()).cloned().collect(),
                numbers: columns.map(number),
            });
        }
        Ok(Self { keys, rows })
    }

    fn from_json(text: &str) -> Result<Self, String> {
        use serde_json::Value;
        let rows: Vec<Value> = serde_json::from_str(text).map_err(|e| e.to_string())?;
        let varied = |row: &Value| row["varied"].as_object().cloned().unwrap_or_default();
        let plain = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        // The members of an object may come in any order: the keys are those of the first case.
        let keys: Vec<String> = rows.first().map(varied).unwrap_or_default().keys().cloned().collect();
        let row = |(n, row): (usize, &Value)| {
            let word = |key: &str| row[key].as_str().map(str::to_owned);
            let varied = varied(row);
            let values: Option<Vec<String>> = keys.iter().map(|key| varied.get(key).map(plain)).collect();
            match (word("status"), word("scenario"), values) {
                (Some(status), Some(scenario), Some(values)) => {
                    let numbers = Figures::NAMES.map(|name| row[name].as_f64().unwrap_or(f64::NAN));
                    Ok(SweepRow { scenario, status, values, numbers })
                }
                _ => Err(format!("case {n} has not status, scenario and all that varies")),
            }
        };
        let rows = rows.iter().enumerate().map(row).collect::<Result<_, String>>()?;
        Ok(Self { keys, rows })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_reads_back_in_both_formats() {
        let heading =
            "case,status,scenario,varied.law.h,varied.formula,formula,start,steps,sigma,h,max_error,reason\n";
        let lines =
            "0,completed,\"a,b\",0.1,ab4,ab4,rk4,100,0.01,0.1,3e-7,\n1,refused,\"a,b\",0.2,ab4,,,,,,,no\n";
        let table = SweepTable::parse(&format!("{heading}{lines}")).unwrap();
        assert_eq!(table.keys, ["law.h", "formula"]);
        assert_eq!((table.rows[0].scenario.as_str(), table.rows[0].figure("max_error")), ("a,b", 3e-7));
        assert!(table.rows[0].is_completed() && !table.rows[1].is_completed());
        assert!(table.rows[1].figure("max_error").is_nan() && table.rows[0].figure("nothing").is_nan());
        assert!(SweepTable::parse("t,left.j1\n0,1\n").unwrap_err().contains("case,status,scenario"));
        assert!(SweepTable::parse(&format!("{heading}1,2\n")).unwrap_err().contains("2 cells"));
    }

    #[test]
    fn a_table_of_objects_reads_back() {
        let text =
            r#"[{"case":0,"status":"completed","scenario":"s","varied":{"law.h":0.1},"max_error":1e-9}]"#;
        let table = SweepTable::parse(text).unwrap();
        assert_eq!((table.rows[0].values[0].as_str(), table.rows[0].figure("max_error")), ("0.1", 1e-9));
        assert!(SweepTable::parse("[{}]").is_err());
    }
}
