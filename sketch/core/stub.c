int ink_stub(void) { return 0; }
