//! A worker that dies, as a process, of some genotypes: the probe system with fatal ones among its genotypes.
//! It exists to show that such a genotype costs three workers and no more.
