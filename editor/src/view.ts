// The viewer of `mbsym view`: picture and motion alone, in one file.
export {};
