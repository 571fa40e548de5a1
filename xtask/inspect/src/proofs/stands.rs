//! Finds the items (functions, types, macros) that each property (statement to prove) uses, directly or indirectly, in the proofs
//! and in the code. A hash of these items shows later whether the proof still applies.
//!
//! A name is resolved by the imports of its file and, in a path `word::name`, by the word before it; a method also by its type and
//! trait. If several items remain possible, all count as used. So no used item is missed, but a change of an item that is not
//! really used can make a proof count as out of date without need.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, HashMap, VecDeque};
use std::rc::Rc;

use super::items::{EMPTY, How, Item, Items, Kind, add};

/// Two hashes of a property (statement to prove): of its statement with all that it uses in the proofs, and of the code that it
/// reaches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Numbers {
    pub statement: u64,
    pub code: u64,
}

/// Number of the crate `proofs` in the order of the crates; crates with lower numbers are the proved code.
pub const PROOFS: usize = 3;

/// All items of the sources, with indexes by which a name is resolved to items.
pub struct Ground<'i> {
    items: &'i Items,
    by_name: BTreeMap<&'i str, Vec<usize>>,
    by_type: BTreeMap<&'i str, Vec<usize>>,
    by_macro: BTreeMap<&'i str, Vec<usize>>,
    by_file: BTreeMap<usize, Vec<usize>>,
    kinds: BTreeMap<&'i str, BTreeSet<(usize, &'i Kind)>>,
    /// Names of macros whose definition contains properties. If such a macro is called with a name as argument, the call does not
    /// count as the name's definition.
    of_properties: BTreeSet<&'i str>,
    /// Names of macros whose definition contains an `impl` for their arguments.
    implementing: BTreeSet<&'i str>,
    /// Names of the modules that are files or folders.
    modules: BTreeSet<&'i str>,
    /// Numbers of the files that call a macro, by the macro's name.
    called: BTreeMap<&'i str, BTreeSet<usize>>,
    /// Pairs of a module and a name that the module imports; the name is `*` for `use …::*`.
    handed_on: BTreeSet<(&'i str, &'i str)>,
    /// Results of [`Ground::seen`] (the items that an item names) that are already known, by the item's index.
    seen: RefCell<HashMap<usize, Rc<[usize]>>>,
}

/// The items that one property uses, directly or indirectly, while they are being collected.
struct Reach<'g, 'i> {
    ground: &'g Ground<'i>,
    reached: BTreeSet<usize>,
    /// Names used so far. Each has the ways in which code uses it (plain name, path, method or macro call) and the crate number of
    /// the item that uses it.
    names: HashMap<&'i str, BTreeSet<(usize, &'i How)>>,
    /// Types reached so far, each with the number of its crate.
    types: BTreeSet<(&'i str, usize)>,
    waiting: VecDeque<usize>,
}

impl<'i> Ground<'i> {
    pub fn of(items: &'i Items) -> Self {
        let mut ground = Self {
            items,
            by_name: BTreeMap::new(),
            by_type: BTreeMap::new(),
            by_macro: BTreeMap::new(),
            by_file: BTreeMap::new(),
            kinds: BTreeMap::new(),
            of_properties: BTreeSet::new(),
            implementing: BTreeSet::new(),
            modules: BTreeSet::new(),
            called: BTreeMap::new(),
            handed_on: BTreeSet::new(),
            seen: RefCell::default(),
        };
        for (at, item) in items.all.iter().enumerate() {
            if is_type(&item.kind) {
                let kinds = ground.kinds.entry(&item.name).or_default();
                kinds.insert((items.files[item.file].rank, &item.kind));
            }
            if item.kind == Kind::Property {
                ground.of_properties.extend(item.within.as_deref());
            }
            for (how, name) in &item.names {
                if *how == How::Bang {
                    ground.called.entry(name).or_default().insert(item.file);
                }
            }
            if let (Some(name), Kind::Member { of: None, .. }) = (&item.within, &item.kind) {
                ground.implementing.insert(name);
            }
            if let Some(name) = &item.within {
                ground.by_macro.entry(name).or_default().push(at);
            }
            let name = item.name.trim_start_matches(':');
            match &item.kind {
                Kind::Property => {}
                Kind::Call if name.is_empty() => {
                    ground.by_file.entry(item.file).or_default().push(at);
                }
                Kind::Call => {
                    ground.by_macro.entry(name).or_default().push(at);
                    for (_, name) in &item.names {
                        ground.by_name.entry(name).or_default().push(at);
                    }
                }
                Kind::Member { of, of_trait } => {
                    ground.by_name.entry(name).or_default().push(at);
                    let mut words = vec![of.as_deref(), of_trait.as_deref()];
                    // Code that uses an operator does not name the type to the operator's left. So all names in such an
                    // implementation count.
                    if of
                        .as_ref()
                        .is_none_or(|of| !of.starts_with(char::is_uppercase))
                    {
                        words.extend(item.names.iter().map(|(_, name)| Some(&**name)));
                    }
                    for word in words.into_iter().flatten() {
                        ground.by_type.entry(word).or_default().push(at);
                    }
                }
                _ => ground.by_name.entry(name).or_default().push(at),
            }
        }
        for file in &items.files {
            ground.modules.extend(file.modules.iter().map(|it| &**it));
            let module = file.modules.last().map_or("", |it| it);
            let names = file.imports.keys().map(|name| (module, &**name));
            ground.handed_on.extend(names);
            if !file.globs.is_empty() {
                ground.handed_on.insert((module, "*"));
            }
        }
        ground
    }

    /// The hashes of each property. The key is the names of file and property, such as `tdpa::p7_leaves`.
    pub fn numbers(&self, built_with: &str) -> BTreeMap<String, Numbers> {
        let mut found = BTreeMap::<String, Numbers>::new();
        for (at, item) in self.items.all.iter().enumerate() {
            if item.kind != Kind::Property {
                continue;
            }
            let numbers = self.number(at, built_with);
            let file = self.items.files[item.file].modules.last();
            let name = format!("{}::{}", file.map_or("", |it| it), item.name);
            // If two modules of a file have a property of the same name, both go into the hash.
            found
                .entry(name)
                .and_modify(|other| {
                    other.statement = add(other.statement, &numbers.statement.to_string());
                    other.code = add(other.code, &numbers.code.to_string());
                })
                .or_insert(numbers);
        }
        found
    }

    fn number(&self, root: usize, built_with: &str) -> Numbers {
        let mut lines: Vec<(bool, String)> = self
            .reached(root)
            .into_iter()
            .map(|at| {
                let item = &self.items.all[at];
                let line = format!("{:?} {} {:016x}", item.kind, item.name, item.number);
                (self.rank(item) == PROOFS, line)
            })
            .collect();
        lines.sort();
        let of = |proofs: bool, from: u64| {
            let lines = lines.iter().filter(|(of, _)| *of == proofs);
            lines.fold(from, |number, (_, line)| add(number, line))
        };
        Numbers {
            statement: of(true, EMPTY),
            code: of(false, add(EMPTY, built_with)),
        }
    }

    fn reached(&self, root: usize) -> BTreeSet<usize> {
        let mut reach = Reach {
            ground: self,
            reached: BTreeSet::new(),
            names: HashMap::new(),
            types: BTreeSet::new(),
            waiting: VecDeque::new(),
        };
        reach.take(root);
        while let Some(at) = reach.waiting.pop_front() {
            reach.go_on(at);
        }
        reach.reached
    }

    /// Indexes of the functions, types and macros whose names the item with the index `at` uses; methods are left out.
    fn seen(&self, at: usize) -> Rc<[usize]> {
        if let Some(known) = self.seen.borrow().get(&at) {
            return known.clone();
        }
        let from = &self.items.all[at];
        let places = self.places(from);
        let mut found = BTreeSet::new();
        for (how, name) in &from.names {
            for to in self.by_name.get(&**name).into_iter().flatten() {
                let item = &self.items.all[*to];
                if !matches!(item.kind, Kind::Member { .. })
                    && (item.kind != Kind::Call || self.may_make(name, item))
                    && self.sees(from, &places, how, name, item)
                {
                    found.insert(*to);
                }
            }
        }
        let found: Rc<[usize]> = found.into_iter().collect();
        self.seen.borrow_mut().insert(at, found.clone());
        found
    }

    /// Whether a macro call may define an item with this name: the name is one of the call's arguments, and no other item has it.
    fn may_make(&self, name: &str, call: &Item) -> bool {
        let others = self.by_name.get(name).into_iter().flatten();
        let mut others = others.map(|at| &self.items.all[*at]);
        !self
            .of_properties
            .contains(call.name.trim_start_matches(':'))
            && others.all(|it| matches!(it.kind, Kind::Call | Kind::Member { .. }))
    }

    fn rank(&self, item: &Item) -> usize {
        self.items.files[item.file].rank
    }

    /// Indexes of the files whose imports resolve the names in an item: its own file, and for a macro also the files that call the
    /// macro.
    fn places(&self, item: &Item) -> BTreeSet<usize> {
        let mut files = BTreeSet::from([item.file]);
        let name = match item.kind {
            Kind::Macro => Some(&*item.name),
            _ => item.within.as_deref(),
        };
        if let Some(called) = name.and_then(|name| self.called.get(name)) {
            files.extend(called);
        }
        files
    }

    /// Whether a name in the item `from`, used in the way `how` (plain name, path, method or macro call), can refer to the item
    /// `to`.
    fn sees(
        &self,
        from: &Item,
        places: &BTreeSet<usize>,
        how: &How,
        name: &str,
        to: &Item,
    ) -> bool {
        if self.rank(from) < self.rank(to) {
            return false;
        }
        places.iter().any(|at| {
            let file = &self.items.files[*at];
            match how {
                How::Dot => false,
                How::Bang => to.kind == Kind::Macro,
                How::After(before) => {
                    let path = file.imports.get(before).and_then(|path| path.last());
                    self.stands(before, name, to)
                        || path.is_some_and(|it| self.stands(it, name, to))
                }
                How::Plain if *at == to.file => true,
                How::Plain => {
                    let before =
                        |path: &Vec<String>| path.len().checked_sub(2).map(|at| path[at].clone());
                    let imported = file.imports.get(name).is_some_and(|path| {
                        before(path).is_none_or(|before| self.stands(&before, name, to))
                    });
                    imported
                        || file
                            .globs
                            .iter()
                            .any(|it| it != "super" && self.stands(it, name, to))
                }
            }
        })
    }

    /// Whether `before::name` can refer to the item `to`.
    fn stands(&self, before: &str, name: &str, to: &Item) -> bool {
        let of_file = &self.items.files[to.file].modules;
        if ["$", "crate", "super", "self"].contains(&before) {
            return true;
        }
        // The word before the name is a type or an enumeration.
        if before.is_empty() || before.starts_with(char::is_uppercase) {
            return false;
        }
        of_file.iter().chain(&to.inline).any(|it| it == before)
            // The name that a macro gives to its module is not known.
            || to.inline.iter().any(String::is_empty) && !self.modules.contains(before)
            || [name, "*"].iter().any(|it| self.handed_on.contains(&(before, *it)))
    }
}

fn is_type(kind: &Kind) -> bool {
    matches!(kind, Kind::Type | Kind::Trait | Kind::Alias)
}

impl<'i> Reach<'_, 'i> {
    fn take(&mut self, at: usize) {
        if self.reached.insert(at) {
            self.waiting.push_back(at);
        }
    }

    fn go_on(&mut self, at: usize) {
        let ground = self.ground;
        let items = ground.items;
        let item = &items.all[at];
        let mut asked: Vec<usize> = ground.by_file.get(&item.file).cloned().unwrap_or_default();
        if let Some(name) = &item.within {
            let of_macro = ground.by_name.get(&**name).into_iter().flatten();
            let calls = ground.by_macro.get(&**name).into_iter().flatten();
            let taken: Vec<usize> = of_macro
                .filter(|at| items.all[**at].kind == Kind::Macro)
                .chain(calls.filter(|at| items.all[**at].kind == Kind::Call))
                .copied()
                .collect();
            for at in taken {
                self.take(at);
            }
        }
        if item.kind == Kind::Macro {
            asked.extend(ground.by_macro.get(&*item.name).into_iter().flatten());
        }
        if is_type(&item.kind) {
            self.types.insert((&item.name, ground.rank(item)));
            asked.extend(ground.by_type.get(&*item.name).into_iter().flatten());
            asked.extend(ground.by_name.get(&*item.name).into_iter().flatten());
        }
        for at in ground.seen(at).iter() {
            self.take(*at);
        }
        for (how, name) in &item.names {
            let known = self.names.entry(name).or_default();
            if known.insert((ground.rank(item), how)) {
                asked.extend(ground.by_name.get(&**name).into_iter().flatten());
                asked.extend(ground.by_type.get(&**name).into_iter().flatten());
            }
        }
        for at in asked {
            if !self.reached.contains(&at) && self.holds(&items.all[at]) {
                self.take(at);
            }
        }
    }

    /// Whether a macro call, or a member of a type, belongs to what the property uses, given the items found so far. Other items
    /// are found by their names.
    fn holds(&self, item: &Item) -> bool {
        let ground = self.ground;
        match &item.kind {
            Kind::Property => false,
            Kind::Call => {
                let name = item.name.trim_start_matches(':');
                // A macro call counts if it implements something for a type that is reached.
                let rank = ground.rank(item);
                name.is_empty()
                    || ground.implementing.contains(name)
                        && item.names.iter().any(|(_, argument)| {
                            ground.kinds.contains_key(&**argument) && self.has_type(argument, rank)
                        })
            }
            Kind::Member { of, of_trait } => {
                let rank = ground.rank(item);
                let of_type = match of {
                    Some(of) => self.has_type(of, rank),
                    None if item.within.is_some() => self.has_macro(item),
                    // For a trait's own methods and for type parameters, the trait or the other named types decide, as far as these
                    // are known.
                    None if !item.name.is_empty() => {
                        of_trait.as_ref().is_none_or(|it| self.has_type(it, rank))
                    }
                    None => {
                        let known = item.names.iter().map(|(_, name)| name);
                        let mut known = known
                            .filter(|name| ground.kinds.contains_key(&***name))
                            .map(|name| self.has_type(name, rank))
                            .peekable();
                        known.peek().is_none() || known.any(|it| it)
                    }
                };
                let is_own = |name: &String| {
                    let kinds = ground.kinds.get(&**name).into_iter().flatten();
                    kinds
                        .into_iter()
                        .any(|(of, kind)| *of == rank && **kind == Kind::Trait)
                };
                let own = of_trait.as_ref().is_some_and(is_own);
                // If a method implements another crate's trait, that crate may call it.
                let by_others = of_trait.is_some() && of.is_some() && !own;
                of_type
                    && (item.name.is_empty() || by_others || self.is_called(item, of.as_deref()))
            }
            // All other items are reached by their names.
            _ => false,
        }
    }

    fn has_macro(&self, item: &Item) -> bool {
        let named = item
            .within
            .as_ref()
            .and_then(|name| self.ground.by_name.get(&**name));
        named
            .into_iter()
            .flatten()
            .any(|at| self.ground.items.all[*at].kind == Kind::Macro && self.reached.contains(at))
    }

    /// Whether the items found so far use a type of this name, seen from the crate with number `rank`. A type that no known item
    /// defines counts as used if its name occurs.
    fn has_type(&self, name: &str, rank: usize) -> bool {
        let kinds = self.ground.kinds.get(name).into_iter().flatten();
        let mut kinds = kinds.filter(|(of, _)| *of <= rank).peekable();
        match kinds.peek() {
            None => self.names.contains_key(name) || !name.starts_with(char::is_uppercase),
            Some(_) => kinds.any(|(of, _)| self.types.contains(&(name, *of))),
        }
    }

    /// Whether an item found so far refers to this method or constant of the type `of`.
    fn is_called(&self, item: &Item, of: Option<&str>) -> bool {
        let ground = self.ground;
        let names = self.names.get(&*item.name).into_iter().flatten();
        names.into_iter().any(|(from, how)| {
            let fits = match how {
                How::Dot => true,
                How::After(before) => {
                    let kinds = ground.kinds.get(&**before).into_iter().flatten();
                    let is_another = kinds.into_iter().any(|(_, kind)| **kind == Kind::Type);
                    of.is_none_or(|of| of == before) || !is_another
                }
                How::Plain | How::Bang => false,
            };
            fits && *from >= ground.rank(item)
        })
    }
}
