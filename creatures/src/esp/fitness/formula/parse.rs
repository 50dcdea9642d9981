//! Reading a formula: recursive descent with a limit on depth. Every error says where and what could stand there.

use super::{FormulaError, Function, Operator, Quantity, Reducer, Term};

/// The longest text, bytes.
const LENGTH_MAX: usize = 2000;
/// How deep parentheses and calls may nest.
const DEPTH_MAX: usize = 32;

const REDUCERS: [(&str, Reducer); 5] = [
    ("first", Reducer::First),
    ("last", Reducer::Last),
    ("mean", Reducer::Mean),
    ("min", Reducer::Min),
    ("max", Reducer::Max),
];
/// With the numbers of arguments that each takes.
const FUNCTIONS: [(&str, Function, usize, usize); 4] = [
    ("clamp01", Function::Clamp01, 1, 1),
    ("abs", Function::Abs, 1, 1),
    ("min", Function::Min, 2, 8),
    ("max", Function::Max, 2, 8),
];

/// Reads a whole text.
pub(super) fn parse(text: &str) -> Result<Term, FormulaError> {
    let mut parser = Parser { text, at: 0, depth: 0 };
    if text.len() > LENGTH_MAX {
        return parser.refuse(format!("{} bytes where {LENGTH_MAX} are the most", text.len()));
    }
    let term = parser.sum()?;
    match parser.peek() {
        None => Ok(term),
        Some(found) => parser.refuse(format!("`{found}` where an operator or the end is expected")),
    }
}

struct Parser<'a> {
    text: &'a str,
    /// Bytes read.
    at: usize,
    depth: usize,
}

type Parsed<T> = Result<T, FormulaError>;

impl<'a> Parser<'a> {
    fn sum(&mut self) -> Parsed<Term> {
        self.chain(&[('+', Operator::Add), ('-', Operator::Subtract)], Parser::product)
    }

    fn product(&mut self) -> Parsed<Term> {
        self.chain(&[('*', Operator::Multiply), ('/', Operator::Divide)], Parser::factor)
    }

    /// Operands joined by operators of one rank, from the left.
    fn chain(
        &mut self,
        operators: &[(char, Operator)],
        operand: fn(&mut Self) -> Parsed<Term>,
    ) -> Parsed<Term> {
        let mut left = operand(self)?;
        while let Some(&(sign, operator)) = operators.iter().find(|(sign, _)| self.peek() == Some(*sign)) {
            self.expect(sign)?;
            left = Term::Joined(operator, Box::new(left), Box::new(operand(self)?));
        }
        Ok(left)
    }

    fn factor(&mut self) -> Parsed<Term> {
        self.depth += 1;
        if self.depth > DEPTH_MAX {
            return self.refuse(format!("nested deeper than {DEPTH_MAX}"));
        }
        let term = match self.peek() {
            Some('-') => {
                self.expect('-')?;
                Term::Negated(Box::new(self.factor()?))
            }
            Some('(') => {
                self.expect('(')?;
                let term = self.sum()?;
                self.expect(')')?;
                term
            }
            Some(found) if found.is_ascii_digit() || found == '.' => Term::Number(self.number()?),
            Some(found) if found.is_ascii_alphabetic() => self.call()?,
            Some(found) => return self.refuse(format!("`{found}` where a number or a name is expected")),
            None => return self.refuse("ends where a number or a name is expected".to_owned()),
        };
        self.depth -= 1;
        Ok(term)
    }

    /// A reducer of a measure, or a function of numbers.
    fn call(&mut self) -> Parsed<Term> {
        self.peek();
        let start = self.at;
        let name = self.name();
        if measure(name).is_some() {
            self.at = start;
            return self.refuse(format!("the measure `{name}` needs a reducer, as in `mean({name})`"));
        }
        let reducer = REDUCERS.iter().find(|(known, _)| *known == name);
        let function = FUNCTIONS.iter().find(|(known, ..)| *known == name);
        if reducer.is_none() && function.is_none() && name != "mean_last" {
            self.at = start;
            return self.refuse(format!(
                "`{name}` where one of first, last, mean, min, max, mean_last, clamp01, abs is expected"
            ));
        }
        self.expect('(')?;
        let term = if name == "mean_last" {
            let quantity = self.quantity()?;
            self.expect(',')?;
            let start = self.at;
            let seconds = self.number()?;
            if seconds <= 0.0 {
                self.at = start;
                return self.refuse("no time at all where some seconds are expected".to_owned());
            }
            Term::MeanLast(quantity, seconds)
        } else if let Some((_, reducer)) = reducer.filter(|_| function.is_none() || self.at_reduced_measure())
        {
            Term::Reduced(*reducer, self.quantity()?)
        } else {
            let (_, function, least, most) = function.expect("what is no reducer here is a function");
            let mut arguments = vec![self.sum()?];
            while self.peek() == Some(',') {
                self.expect(',')?;
                arguments.push(self.sum()?);
            }
            if !(*least..=*most).contains(&arguments.len()) {
                let count = arguments.len();
                let allowed = if least == most { format!("{least}") } else { format!("{least} to {most}") };
                return self.refuse(format!("`{name}` of {count} numbers where it takes {allowed}"));
            }
            Term::Called(*function, arguments)
        };
        self.expect(')')?;
        Ok(term)
    }

    /// Whether a measure and a closing parenthesis follow.
    fn at_reduced_measure(&mut self) -> bool {
        self.peek();
        let start = self.at;
        let reduced = measure(self.name()).is_some() && self.peek() == Some(')');
        self.at = start;
        reduced
    }

    fn quantity(&mut self) -> Parsed<Quantity> {
        self.peek();
        let start = self.at;
        let name = self.name();
        if let Some(quantity) = measure(name) {
            return Ok(quantity);
        }
        self.at = start;
        let known = Quantity::ALL.map(Quantity::name).join(", ");
        self.refuse(format!("`{name}` where a measure is expected, one of {known}"))
    }

    fn number(&mut self) -> Parsed<f64> {
        self.peek();
        let rest = &self.text[self.at..];
        let end = rest.find(|letter: char| !letter.is_ascii_digit() && letter != '.').unwrap_or(rest.len());
        match rest[..end].parse::<f64>() {
            Ok(number) if number.is_finite() => {
                self.at += end;
                Ok(number)
            }
            _ => self.refuse(format!("`{}` where a number is expected", &rest[..end])),
        }
    }

    fn name(&mut self) -> &'a str {
        let rest = &self.text[self.at..];
        let end = rest.find(|letter: char| !letter.is_ascii_alphanumeric() && letter != '_');
        let name = &rest[..end.unwrap_or(rest.len())];
        self.at += name.len();
        name
    }

    /// The next character that is no blank, which stays.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    fn expect(&mut self, sign: char) -> Parsed<()> {
        match self.peek() {
            Some(found) if found == sign => {
                self.at += sign.len_utf8();
                Ok(())
            }
            Some(found) => self.refuse(format!("`{found}` where `{sign}` is expected")),
            None => self.refuse(format!("ends where `{sign}` is expected")),
        }
    }

    fn refuse<T>(&self, problem: String) -> Parsed<T> {
        let column = self.text[..self.at].chars().count() + 1;
        Err(FormulaError { column, problem })
    }
}

fn measure(name: &str) -> Option<Quantity> {
    Quantity::ALL.into_iter().find(|quantity| quantity.name() == name)
}
